"""The truth for report_test.py: results made by the built gibench, and their pixels as oiiotool prints them."""
import atexit
import csv
import functools
import json
import os
import re
import subprocess
import tempfile

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
# Those of the report: "path spp=16" is "path spp=64" that stopped earlier.
METHODS = ("path spp=64", "photon_mapper photons=2000 spp=8", "radiosity patch=0.2 spp=8",
           "bidirectional techniques=on spp=8")
SCENES = ("cornell-box", "cornell-glass")
SIZE = 32

EXPERIMENT = f"""title = "A test of the report: <b>&amp; co"
scenes = ["{ROOT}/scenes/cornell-box.xml", "{ROOT}/scenes/cornell-glass.xml"]
resolution = [{SIZE}, {SIZE}]
seeds = 3
[reference]
method = "path"
seconds = 2
[[method]]
name = "path"
label = "path spp=64"
spp = [16, 64]
[[method]]
name = "photon_mapper"
label = "photon_mapper photons=2000 spp=8"
photons = 2000
spp = 8
[[method]]
name = "radiosity"
label = "radiosity patch=0.2 spp=8"
patch = 0.2
spp = 8
[[method]]
name = "bidirectional"
label = "bidirectional techniques=on spp=8"
techniques = "on"
spp = 8
"""


@functools.cache
def shared_results(program):
    """The result folder of a small experiment; it exists until the process ends."""
    parent = tempfile.TemporaryDirectory()
    atexit.register(parent.cleanup)
    return make_results(program, parent.name)


def make_results(program, folder):
    """Runs a small experiment; returns the result folder."""
    path = os.path.join(folder, "small.toml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(EXPERIMENT)
    out = os.path.join(folder, "results")
    run = subprocess.run([program, "run", path, "--out", out], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return out


def cell_folder(results, scene, method, seed):
    """The folder of a cell, found by the cell's record."""
    cells = os.path.join(results, "cells")
    plain = re.sub(r"[^\w.=+-]", "_", f"{scene}-{method}")
    found = [name for name in os.listdir(cells) if name.startswith(plain + "-") and name.endswith(f"-s{seed}")]
    assert len(found) == 1, found
    return os.path.join(cells, found[0])


def record(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return json.load(file)


def checkpoints(results, scene, method, seed):
    """The checkpoints in a cell's record: passes, seconds, errors by component."""
    return record(cell_folder(results, scene, method, seed), "cell.json")["checkpoints"]


def pixels(path, layer=""):
    """{(x, y): (r, g, b)} as oiiotool prints an image."""
    run = subprocess.run(["oiiotool", "--info", "-v", "--dumpdata", path], capture_output=True, text=True, check=True)
    names = re.search(r"channel list: (.*)", run.stdout)[1].split(", ")
    at = [names.index((layer + "." if layer else "") + c) for c in "RGB"]
    found = {}
    for x, y, values in re.findall(r"Pixel \((\d+), (\d+)\): ([^\n]*)", run.stdout):
        found[int(x), int(y)] = tuple(float(values.split()[i]) for i in at)
    assert len(found) == SIZE * SIZE, f"{path}: {len(found)} pixels"
    return found


def rows(results, name):
    with open(os.path.join(results, name), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def linear(byte):
    """The linear value, from 0 to 1, of an sRGB byte."""
    v = byte / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def srgb(value):
    """The byte that shows a linear value."""
    v = min(1, max(0, value))
    return 255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055)
