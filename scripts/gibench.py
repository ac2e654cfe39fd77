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
import re
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
PROGRAM = os.path.join(ROOT, "build", "release", "experiments", "gibench")
# Linear RGB with sRGB's primaries of CIE 1931 X, Y, Z: a column for each of R, G, B.
RGB_OF_XYZ = ((3.240479, -0.969256, 0.055648), (-1.537150, 1.875991, -0.204043), (-0.498535, 0.041556, 1.057311))
# The layers that gibench reads by their names.
OWN_LAYER = re.compile("(|emission|direct|caustic|indirect|volume|stderr|bias|group[0-9]*)(_.*)?")
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
    "" is the image itself, or the only layer; its classes of light paths are `emission`, `direct`, `caustic`, `indirect` and
    `volume`. References also have standard errors, `stderr` and `caustic_stderr`, and the means of independent groups of samples,
    `group00`, `caustic_group00` and so on. As `gibench compare` does it: X, Y and Z and the sRGB curve of 8 bits are converted, a
    layer of luminance Y alone is grey, and of overscan nothing is left. Raises OSError for a file that cannot be read whole or has
    no such layer."""
    import OpenImageIO  # the tables need none of it
    file = OpenImageIO.ImageInput.open(path)
    if not file:
        raise OSError(f"{path}: {OpenImageIO.geterror()}")
    try:
        values, names = displayed(file, path)
    finally:
        file.close()
    places = {}
    for place, name in enumerate(names):
        layer, _, channel = name.rpartition(".")
        capital = channel.upper() if channel in ("r", "g", "b") and name[:-1] + channel.upper() not in names else channel
        places.setdefault(layer, {})[capital] = place
    found = {layer: image for layer, channels in places.items()
             if (image := layer_of(values, channels, len(names) == 1)) is not None}
    for layer, channels in places.items():
        if layer not in found and channels.keys() & {"R", "G", "B", "X"} and OWN_LAYER.fullmatch(layer):
            raise OSError(f"{path}: the layer '{layer}' has channels {', '.join(channels)}, but not all of R, G, B or X, Y, Z")
    if not found:
        raise OSError(f"{path}: it has no layer of R, G, B or Y; its channels are: {', '.join(names)}")
    if len(found) == 1:
        found.setdefault("", next(iter(found.values())))
    return found


def displayed(file, path):
    """The linear values of an open image, height x width x channels, and the names of the channels."""
    import OpenImageIO
    spec = file.spec()
    if spec.deep or spec.depth > 1:
        raise OSError(f"{path}: a deep image or a volume; only flat images are supported")
    values = file.read_image(OpenImageIO.FLOAT)
    if values is None:
        raise OSError(f"{path}: the image is damaged: {file.geterror()}")
    left, top = spec.full_x - spec.x, spec.full_y - spec.y
    if left < 0 or top < 0 or left + spec.full_width > spec.width or top + spec.full_height > spec.height:
        raise OSError(f"{path}: a cropped image: its pixels do not cover the display window")
    values = values[top:top + spec.full_height, left:left + spec.full_width]
    is_float = spec.format.basetype in (OpenImageIO.HALF, OpenImageIO.FLOAT, OpenImageIO.DOUBLE)
    if spec.get_string_attribute("oiio:ColorSpace") == "sRGB" and not is_float:
        low = values <= 0.04045
        values[low] /= 12.92
        values[~low] = ((values[~low] + 0.055) / 1.055) ** 2.4
    if file.seek_subimage(1, 0):
        raise OSError(f"{path}: the file has several parts; one is supported")
    return values, spec.channelnames


def layer_of(values, channels, is_only):
    """The image of a layer with these channels, places by name; None for a layer that is no colour. `is_only`: whether the file
    has no other channel."""
    if {"R", "G", "B"} <= channels.keys():
        return values[:, :, [channels[c] for c in "RGB"]]
    if {"X", "Y", "Z"} <= channels.keys():
        return (values[:, :, [channels[c] for c in "XYZ"]].astype(float) @ RGB_OF_XYZ).astype(values.dtype)
    is_part = "X" in channels or "RY" in channels  # of a colour, of which Y is not all
    if not is_part and (is_only or "Y" in channels):
        return values[:, :, [channels.get("Y", 0)] * 3]
    return None


def run(experiment, *options, out=None, program=PROGRAM):
    """Runs `gibench run EXPERIMENT --out OUT OPTIONS...` and returns the folder of the results: `out`, else results/ and the
    file's name in the current folder. Complete cells are kept. Raises subprocess.CalledProcessError if it fails; what it
    says stands on stderr."""
    folder = out or os.path.join("results", os.path.splitext(os.path.basename(experiment))[0])
    subprocess.run([program, "run", experiment, "--out", folder, *options], check=True, stdout=subprocess.DEVNULL)
    return folder
