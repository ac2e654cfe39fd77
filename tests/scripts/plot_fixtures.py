"""Result folders of known content, and figures read as SVG, for plot_test.py."""
import math
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
PLOT = os.path.join(ROOT, "scripts", "plot")
sys.path.insert(0, os.path.join(ROOT, "scripts"))

from plotting import result_tables  # noqa: E402  found by the line above

SVG = "{http://www.w3.org/2000/svg}"
HREF = "{http://www.w3.org/1999/xlink}href"
METHODS = ("path spp=4", "photon_mapper photons=1e4 & 50%")

# rel_mse_corrected of seeds 1, 2, 3 is 0.75, 1 and 1.25 times its mean of 0.16 / pass, so that the error is
# 40 % / sqrt(pass). The plain rel_mse is another number, which nothing may show.
CURVES = "scene,method,seed,pass,seconds,mse_corrected,rel_mse,rel_mse_corrected\n" + "".join(
    f"box,{method},{seed},{number},{(1 + m) * number * (0.9 + 0.05 * seed)},{0.02 / number},7,"
    f"{0.16 / number * (0.5 + 0.25 * seed)}\n"
    for m, method in enumerate(METHODS) for seed in (1, 2, 3) for number in (1, 2, 4, 16))
TABLE_HEAD = ",".join(result_tables.TABLE) + "\n"


def table_line(**fields):
    return ",".join(str(fields.get(column, "")) for column in result_tables.TABLE) + "\n"


TOTAL = {"scene": "box", "component": "total", "rel_mse": 0.0102, "rel_mse_lo": 0.0083,
         "rel_mse_hi": 0.0123, "rel_mse_corrected": 0.01, "rel_mse_resolved": 0.0004}
TABLE = TABLE_HEAD + table_line(
    **TOTAL, method="path spp=4", seconds=16, bias2=-2e-05, bias2_lo=-4e-05, bias2_hi=3e-05, variance=0.00123,
    variance_lo=0.001, variance_hi=0.0015, seconds_to_5pct=3.456, seconds_to_5pct_state="measured",
    seconds_to_2pct_state="extrapolated", seconds_to_2pct_lo=20, seconds_to_2pct_hi=25,
    seconds_to_1pct_state="at least", seconds_to_1pct_lo=88) + table_line(
    scene="box", method="path spp=4", component="direct", seconds=16, rel_mse_corrected=0.0025, rel_mse_resolved=0.01,
    bias2=1e-06, bias2_lo=5e-07, bias2_hi=2e-06, variance=0.0004, variance_lo=0.0003, variance_hi=0.0005,
    bias_state="unbiased", seconds_to_5pct=1.5, seconds_to_5pct_state="measured", seconds_to_2pct_state="not reached",
    seconds_to_1pct_state="below the reference's noise") + table_line(
    **TOTAL, method="photon_mapper photons=1e4 & 50%", seconds=32, bias2=0.0002, bias2_lo=0.0001, bias2_hi=0.0004,
    variance=0.00012345, variance_lo=0.0001, variance_hi=0.0002, seconds_to_5pct=12.34, seconds_to_5pct_state="measured",
    seconds_to_2pct=1234567, seconds_to_2pct_state="measured", seconds_to_1pct_state="never",
    effects_missing="caustics;glossy_lobes", components_missing="caustic;indirect")


def result_folder(parent, **files):
    folder = tempfile.mkdtemp(dir=parent)
    for name, text in {"curves": CURVES, "table": TABLE, **files}.items():
        if text is not None:
            with open(os.path.join(folder, name + ".csv"), "w", encoding="utf-8") as file:
                file.write(text)
    return folder


def plot(*arguments, program=(PLOT,), **environment):
    return subprocess.run([*program, *arguments], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})


def content(folder):
    found = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = file.read()
    return found


class Svg:
    """Positions in a figure, and their values according to the numbers at the axes' ticks."""

    def __init__(self, path):
        self.root = ElementTree.parse(path).getroot()
        self.groups = {group.get("id"): group for group in self.root.iter(SVG + "g") if group.get("id")}
        self.paths = {path.get("id"): path.get("d") for path in self.root.iter(SVG + "path") if path.get("id")}

    def text(self):
        return [" ".join("".join(each.itertext()).split()) for each in self.root.iter(SVG + "text")]

    def marks(self, name):
        return [(float(use.get("x")), float(use.get("y"))) for use in self.groups[name].iter(SVG + "use")]

    def corners(self, name):
        d = next(self.groups[name].iter(SVG + "path")).get("d")
        return [tuple(map(float, pair)) for pair in re.findall(r"([-0-9.]+) ([-0-9.]+)", d)]

    def band(self, name):
        offset = float(next(self.groups[name].iter(SVG + "use")).get("y"))
        return [(x, y + offset) for x, y in self.corners(name)]

    def ticks(self, axes, direction):
        """(value, position) of the ticks that have numbers."""
        found = []
        for name, group in self.groups.items():
            text = [" ".join("".join(each.itertext()).split()) for each in group.iter(SVG + "text")]
            if not name.startswith(direction + "tick_") or group not in list(self.groups[axes].iter()) or not text:
                continue
            power = re.fullmatch(r"(?:(\d)\u22c5)?10\s*[\u2212-]\s*(\d+)", text[0])
            value = int(power[1] or 1) * 10.0 ** -int(power[2]) if power else float(text[0])
            use = next(group.iter(SVG + "use"))
            found.append((value, float(use.get(direction))))
        return found

    def axis(self, axes, direction, logarithmic):
        """The function from a position to its value; every tick must agree with the outermost two."""
        bend = math.log if logarithmic else float
        ticks = [(bend(value), position) for value, position in self.ticks(f"axes_{axes}", direction)]
        (low, start), (high, end) = ticks[0], ticks[-1]
        slope = (high - low) / (end - start)
        assert all(abs(low + slope * (position - start) - value) < 1e-4 * abs(high - low) for value, position in ticks)
        return lambda position: (math.exp if logarithmic else float)(low + slope * (position - start))


SWEEP = TABLE_HEAD + "".join(table_line(
    scene="box", component=component, method=f"m photons={photons} k=5", label=f"m photons={photons}", seconds=1,
    rel_mse_corrected=0.01, rel_mse_resolved=1e-6, bias2=scale / photons, bias2_lo=0.5 * scale / photons if resolved else -1e-9,
    bias2_hi=2 * scale / photons, variance=1e-4, variance_lo=5e-5, variance_hi=2e-4, bias_state="measured")
    for component, scale, resolved in (("total", 1, False), ("caustic", 2, True)) for photons in (1000, 10000, 100000))
LAWS = (",".join(result_tables.BIAS_LAWS) + "\n"
        "box,m k=5,photons,caustic,3,3,1.0,0.9,1.1,2,2\nbox,m k=5,photons,total,3,0,,,,2,\n")
