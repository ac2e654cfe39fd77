"""Results of gibench in Python: tables as records, layers of images as arrays, experiments from a notebook.

    import sys; sys.path.append("scripts")
    import gibench
    folder = gibench.run("experiments/first-look.toml", "--seeds", "3")
    rows = gibench.table(folder)                          # dicts: pandas.DataFrame(rows) takes them as they are
    image = gibench.layers("x.exr")["caustic"]            # float32, height x width x 3, row 0 on top

It needs numpy and OpenImageIO (Debian: scripts/packages-python.txt) and computes no metric.
"""
import csv
import json
import os
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
PROGRAM = os.path.join(ROOT, "build", "release", "experiments", "gibench")
# Columns that hold words even where these look like numbers.
WORDS = {"scene", "method", "label", "component", "passes", "cpu"}


def value_of(column, text):
    """A number, None for an empty field, or the words as they are."""
    if text == "":
        return None
    if column in WORDS:
        return text
    try:
        return float(text)
    except ValueError:
        return text


def table(folder, name="table.csv"):
    """The rows of a CSV file in a result folder as dicts by column: numbers, words, or None where a field is empty."""
    with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
        return [{column: value_of(column, text) for column, text in row.items()} for row in csv.DictReader(file, strict=True)]


def unlike(folder, other):
    """By scene, what changes the meaning of the numbers of two result folders and not the images: {"epsilon": (before, after)}
    and so on, as their manifests list it; scenes with none are left out. Numbers of a scene that is named here do not compare, but for
    `reference`, and but for errors after equal passes with `threads`."""
    def quantities(path):
        with open(os.path.join(path, "manifest.json"), encoding="utf-8") as file:
            return {scene["name"]: scene.get("quantities", {}) for scene in json.load(file)["scenes"]}
    before, after = quantities(folder), quantities(other)
    found = {scene: {name: (before[scene][name], after[scene][name]) for name in before[scene].keys() & after[scene].keys()
                     if before[scene][name] != after[scene][name]}
             for scene in before.keys() & after.keys()}
    return {scene: differences for scene, differences in found.items() if differences}


def layers(path):
    """The layers of an image by name: arrays of linear radiance [W/(sr m^2)], float32, height x width x 3, row 0 on top.
    "" is the image itself; its classes of light paths are `emission`, `direct`, `caustic`, `indirect` and `volume`. References
    also have standard errors, `stderr` and `caustic_stderr`, and the means of independent groups of samples, `group00`,
    `caustic_group00` and so on. A layer of luminance Y alone is grey. Raises OSError for a file that cannot be read or has no
    such layer."""
    import OpenImageIO  # the tables need none of it
    file = OpenImageIO.ImageInput.open(path)
    if not file:
        raise OSError(f"{path}: {OpenImageIO.geterror()}")
    names = file.spec().channelnames
    values = file.read_image(OpenImageIO.FLOAT)
    file.close()
    places = {}
    for place, name in enumerate(names):
        layer, _, channel = name.rpartition(".")
        places.setdefault(layer, {})[channel.upper()] = place
    found = {layer: values[:, :, [channels.get(c, channels.get("Y")) for c in "RGB"]]
             for layer, channels in places.items() if {"R", "G", "B"} <= channels.keys() or "Y" in channels}
    if not found:
        raise OSError(f"{path}: it has no layer of R, G, B or Y; its channels are: {', '.join(names)}")
    return found


def run(experiment, *options, out=None, program=PROGRAM):
    """Runs `gibench run EXPERIMENT --out OUT OPTIONS...` and returns the folder of the results: `out`, else results/ and the
    file's name in the current folder. Complete cells are kept. Raises subprocess.CalledProcessError if it fails; what it
    says stands on stderr."""
    folder = out or os.path.join("results", os.path.splitext(os.path.basename(experiment))[0])
    subprocess.run([program, "run", experiment, "--out", folder, *options], check=True, stdout=subprocess.DEVNULL)
    return folder
