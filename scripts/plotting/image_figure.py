"""Draws the reference and the methods' images after equal time side by side, with crops enlarged below them."""
import glob
import json
import math
import os
import re
import textwrap
from dataclasses import dataclass

import numpy
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from plotting.result_tables import InputError, select, unique

CROP_COLORS = ("#e69f00", "#56b4e9", "#cc79a7", "#009e73")
LATE = 1.1  # as in the report, an image may be a tenth later than the time at which all are compared
GAP, TEXT, LETTER = 0.04, 0.11, 0.05  # inches


@dataclass
class Shown:
    """An image, linear radiance of height x width x 3, and the words below it."""
    name: str
    detail: str
    pixels: numpy.ndarray


def three_digits(value):
    """Without the point that `#` leaves behind three digits."""
    return f"{value:#.3g}".rstrip(".") if value < 999.5 else f"{value:.0f}"


def cell_records(folder):
    """The folder, the seed and whether more time would not change the image of each cell, by (scene, label)."""
    found = {}
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), "cells", "*", "cell.json"))):
        with open(path, encoding="utf-8") as file:
            record = json.load(file)
        found.setdefault((record["scene"], record["method"]), []).append(
            (os.path.dirname(path), record["seed"], record.get("converged", False)))
    return found


def mean_seconds(rows):
    """The mean time of the seeds' final images [s]; `rows`: those of curves.csv for one scene and method."""
    last = [max((row for row in select(rows, seed=seed)), key=lambda row: row["pass"])["seconds"]
            for seed in unique(row["seed"] for row in rows)]
    return math.fsum(last) / len(last)


def equal_time(scene, curves, cells):
    """The time of the report (Contest::equal_time): the shortest mean time of the methods' final images [s] without those that
    have converged; the longest if each has. `curves`: rows of curves.csv for this scene."""
    seconds = {method: mean_seconds(select(curves, method=method)) for method in unique(row["method"] for row in curves)}
    running = [mean for method, mean in seconds.items()
               if not all(converged for _, _, converged in cells.get((scene, method), [("", 1, False)]))]
    return min(running, default=max(seconds.values()))


def image_by(cell, rows, seconds, final):
    """The file and the row of curves.csv of seed 1's last image that was kept by then, else of its first; `rows`: all seeds."""
    rows = sorted(select(rows, seed="1"), key=lambda row: row["pass"])
    files = {row["pass"]: os.path.join(cell, "frames", f"{row['pass']:.0f}.exr") for row in rows[:-1]}
    files[rows[-1]["pass"]] = os.path.join(cell, "final.exr")
    kept = [row for row in rows if os.path.exists(files[row["pass"]])]
    if not kept:
        raise InputError(f"{cell}: it holds no image")
    by_then = kept if final else [row for row in kept if row["seconds"] <= LATE * seconds]
    row = by_then[-1] if by_then else kept[0]
    return files[row["pass"]], row, not by_then


def shown_images(folder, scene, curves, labels, read):
    """The equal time, the reference and an image of each method of `labels` (names by label); `read` returns the pixels of a
    file."""
    cells = cell_records(folder)
    seconds = equal_time(scene, curves, cells)
    images = [Shown("reference", "", read(os.path.join(folder, "images", f"{scene}-reference.exr")))]
    for method, name in labels.items():
        rows = select(curves, method=method)
        first = [cell for cell, seed, _ in cells.get((scene, method), []) if seed == 1]
        if not select(rows, seed="1") or not first:
            continue
        # Seeds differ in speed: the final image of the fastest method is by the equal time, which is their mean.
        path, row, is_late = image_by(first[0], rows, seconds, mean_seconds(rows) <= seconds)
        error, time = row["rel_mse_corrected"], f"{three_digits(row['seconds'])} s"
        percent = f"{three_digits(100 * math.sqrt(error))} %, " if error is not None and error > 0 else ""
        images.append(Shown(name, f"first image after {time}" if is_late else percent + time, read(path)))
    return seconds, images


def checked_crop(crop, pixels):
    x, y, width, height = crop
    if x + width > pixels.shape[1] or y + height > pixels.shape[0]:
        raise InputError(f"--crop {x},{y},{width},{height} exceeds the image of {pixels.shape[1]} x {pixels.shape[0]} pixels")
    return crop


def srgb(pixels, exposure):
    linear = numpy.clip(numpy.nan_to_num(pixels * exposure), 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def image_sheet(images, crops, width):
    """A figure `width` inches wide: a column for each image, its crops below it, its name and its error below these."""
    reference = images[0].pixels
    crops = [checked_crop(crop, reference) for crop in crops]
    if any(image.pixels.shape != reference.shape for image in images):
        raise InputError("images along the curve are smaller than the film, so that crops would not agree")
    luminance = float((reference @ numpy.array([0.212671, 0.715160, 0.072169])).mean())
    exposure = 0.3 / luminance if luminance > 0 else 1  # as in the report
    column = (width - GAP * (len(images) - 1)) / len(images)
    heights = [column * reference.shape[0] / reference.shape[1], *(column * crop[3] / crop[2] for crop in crops)]
    letters = max(int(column / LETTER), 6)
    # A space before a unit is not broken.
    texts = [[line for text in (image.name, re.sub(r" (?=%|s$)", "\N{NO-BREAK SPACE}", image.detail))
              for line in textwrap.wrap(text, letters, break_on_hyphens=False)] for image in images]
    height = sum(heights) + GAP * len(crops) + (max(map(len, texts)) + 0.4) * TEXT
    figure = Figure(figsize=(width, height))
    for number, image in enumerate(images):
        left, top = number * (column + GAP), height
        for place, size in enumerate(heights):
            axes = figure.add_axes((left / width, (top - size) / height, column / width, size / height))
            axes.set_axis_off()
            if place == 0:
                axes.imshow(srgb(image.pixels, exposure), interpolation="none", aspect="auto")
                for color, (x, y, w, h) in zip(CROP_COLORS, crops):
                    axes.add_patch(Rectangle((x - 0.5, y - 0.5), w, h, fill=False, edgecolor=color, linewidth=0.8))
            else:
                x, y, w, h = crops[place - 1]
                axes.imshow(srgb(image.pixels[y:y + h, x:x + w], exposure), interpolation="none", aspect="auto")
                axes.add_patch(Rectangle((0, 0), 1, 1, transform=axes.transAxes, fill=False, linewidth=1.6,
                                         edgecolor=CROP_COLORS[(place - 1) % len(CROP_COLORS)]))
            top -= size + GAP
        for line, text in enumerate(texts[number], 1):
            figure.text((left + column / 2) / width, (top + GAP - line * TEXT) / height, text, ha="center", fontsize=6,
                        fontfamily="sans-serif", parse_math=False)
    return figure


def caption(images, scene, seconds, formats, escaped):
    """A LaTeX figure that shows the PDF, or else the PNG or the SVG; `formats`: those of the figure's files."""
    form = min(formats, key=("pdf", "png", "svg").index)
    command = r"\includesvg" if form == "svg" else r"\includegraphics"
    words = "; ".join(f"{image.name}: {image.detail}" for image in images[1:])
    return "\n".join([
        f"% needs \\usepackage{{{'svg' if form == 'svg' else 'graphicx'}}}",
        r"\begin{figure}", r"  \centering", rf"  {command}[width=\linewidth]{{images-{scene}.{form}}}",
        rf"  \caption{{{escaped(scene)} after {three_digits(seconds)}\,s: relative RMSE and time of one image. "
        rf"{escaped(words)}.}}",
        r"\end{figure}", ""])
