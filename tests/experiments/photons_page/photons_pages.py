"""The pages that photons_test.py opens, and the numbers in them."""
import base64
import json
import os
import re
import struct
import subprocess

from browser_case import ROOT

# Name of the page: scene and arguments of `gibench photons`.
PAGES = {
    "box": ("cornell-box", "--method", "photon_mapper photons=4000 gather=16 cache=on accuracy=0.3"),
    "glass": ("glass-sphere", "--method", "photon_mapper photons=20000", "--photons-shown", "3000"),
    "fog": ("fog", "--method", "photon_mapper photons=4000"),
    "beams": ("fog", "--method", "photon_mapper photons=4000 volume=beams"),
    "passes": ("cornell-box", "--method", "progressive_photon_mapper photons=1000 radius=0.1", "--passes", "3"),
    "rainbow": ("rainbow", "--method", "photon_mapper photons=3000"),
    "radiosity": ("cornell-box", "--method", "radiosity patch=0.1"),
    "estimates": ("cornell-box", "--method", "photon_mapper photons=4000 k=20"),
}

# A point light, a ball of glass that splits light by wavelength, and a floor.
RAINBOW = """<scene version="3.0.0">
<sensor type="perspective"><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0,-6,4" target="0,0,0.5" up="0,0,1"/></transform></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform>
<bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf></shape>
<shape type="sphere"><point name="center" x="0" y="0" z="1.5"/><float name="radius" value="0.7"/>
<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="cauchy_b" value="0.02"/></bsdf></shape>
<emitter type="point"><point name="position" x="1" y="0" z="5"/><rgb name="intensity" value="50"/></emitter></scene>
"""


class Page:
    """The file of a page and the numbers in it."""

    def __init__(self, program, folder, name):
        scene, *arguments = PAGES[name]
        self.path = os.path.join(folder, name + ".html")
        path = f"{ROOT}/scenes/{scene}.xml"
        if scene == "rainbow":
            path = os.path.join(folder, "rainbow.xml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(RAINBOW)
        run = subprocess.run([program, "photons", path, "--resolution", "32x32", *arguments,
                              "-o", self.path], capture_output=True, text=True, check=False, cwd=folder)
        assert run.returncode == 0, run.stderr
        with open(self.path, encoding="utf-8") as file:
            self.text = file.read()
        self.facts = json.loads(re.search(r'id="facts">(.*?)</script>', self.text)[1])
        infos = self.array("photon-infos", "4B")
        self.bounces = [info[0] for info in infos]
        self.maps = [info[1] for info in infos]
        self.passes = [info[3] for info in infos]

    def array(self, name, form):
        text = re.search(rf'id="array-{name}">(.*?)</script>', self.text)[1]
        return list(struct.iter_unpack("<" + form, base64.b64decode(text)))
