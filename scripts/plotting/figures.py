"""Draws the figures with matplotlib. They are readable in print, in black and white and by the colour-blind, and the
same data give the same bytes. Lengths are in inches, as for the width of a journal's column; nothing is cropped or
scaled later."""
import io
import math
import textwrap

import matplotlib

matplotlib.use("agg")
from matplotlib import ticker  # noqa: E402  the backend has to be chosen first
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

STYLE = {
    "font.size": 7.5, "axes.labelsize": 7.5, "xtick.labelsize": 7, "ytick.labelsize": 7, "legend.fontsize": 7,
    "axes.linewidth": 0.6, "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "hatch.linewidth": 0.5, "path.simplify": False,
    # Text stays text in PDF and SVG, so that it can be searched.
    "pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "gibench",
}
METADATA = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {}}
# Okabe and Ito's colours, without their yellow, which is too light for lines, and then Tol's wine, olive, indigo and grey. The
# lengths of the three lists have no common divisor, so that combinations repeat late.
COLORS = ("#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255", "#999933",
          "#332288", "#777777")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")
DASHES = ((), (5, 1.5), (1.5, 1), (5, 1.5, 1, 1.5), (8, 1.5))
REFERENCE_GREY = "#d4d4d4"
LEFT, RIGHT, TOP, AXIS_TEXT, LINE = 0.52, 0.1, 0.08, 0.36, 0.13
CHARACTER = 0.058  # mean width of a letter [inches]
AS_TYPED = {"parse_math": False}  # of texts with labels, in which "$" is no sign of mathematics


def line_style(index):
    return {"color": COLORS[index % len(COLORS)], "marker": MARKERS[index % len(MARKERS)], "markersize": 2.8,
            "dashes": DASHES[index % len(DASHES)], "linewidth": 1, "markeredgewidth": 0.5}


def power_text(value, _):
    exponent = math.floor(math.log10(value) + 1e-9)
    digit = round(value / 10 ** exponent)
    return f"$10^{{{exponent}}}$" if digit == 1 else rf"${digit}\cdot10^{{{exponent}}}$"


def log_ticks(axis, low, high):
    """Puts numbers at powers of ten and, if there are few of these, at multiples of them."""
    decades = math.log10(high / low)
    digits = (1, 2, 5) if decades < 1.7 else (1, 3) if decades < 2.6 else (1,)
    digits = range(1, 10) if decades < 0.5 else digits
    axis.set_major_locator(ticker.LogLocator(subs=digits, numticks=100))
    axis.set_minor_locator(ticker.LogLocator(subs=range(1, 10), numticks=100))
    plain = low > 5e-4 and high < 2e4
    axis.set_major_formatter(ticker.FuncFormatter((lambda value, _: f"{value:g}") if plain else power_text))
    axis.set_minor_formatter(ticker.NullFormatter())


def log_limits(values, margin=0.06):
    low, high = min(values), max(values)
    factor = max((high / low) ** margin, 1.15)
    return low / factor, high * factor


def saved(figure, form):
    """The bytes of a figure's file."""
    file = io.BytesIO()
    figure.savefig(file, format=form, dpi=600 if form == "png" else 72, metadata=METADATA[form])
    return file.getvalue()


class Sheet:
    """A figure of width `width`: plots of the given heights above each other, and the legend below them."""

    def __init__(self, width, heights, handles, heading="", left=LEFT, handle_length=3.4):
        self.width, self.handles, self.heading, self.handle_length = width, handles, heading, handle_length
        gap = 0.12
        heading_lines = heading.count("\n") + 1 if heading else 0
        self.legend_height = LINE * (self.legend_lines() + heading_lines) + 0.08
        self.height = TOP + sum(heights) + gap * (len(heights) - 1) + AXIS_TEXT + self.legend_height
        self.figure = Figure(figsize=(width, self.height))
        self.axes, top = [], self.height - TOP
        for height in heights:
            box = (left, top - height, width - left - RIGHT, height)
            self.axes.append(self.figure.add_axes((box[0] / width, box[1] / self.height, box[2] / width,
                                                   box[3] / self.height)))
            self.axes[-1].yaxis.set_label_coords(-0.38 / box[2], 0.5)
            top -= height + gap
        for axes in self.axes[:-1]:
            axes.tick_params(labelbottom=False)

    def legend_lines(self):
        """Wraps the labels to the width, in as many columns as fit. Returns the number of lines."""
        labels = [label for _, label in self.handles]
        for columns in (3, 2, 1):
            letters = int((self.width - 0.2) / columns / CHARACTER - 1.7 * self.handle_length - 2)
            if columns == 1 or all(len(label) <= letters for label in labels):
                break
        self.columns = min(columns, max(len(labels), 1))
        wrapped = [textwrap.fill(label, max(letters, 12), subsequent_indent="  ", break_on_hyphens=False)
                   for label in labels]
        self.handles = [(handle, label) for (handle, _), label in zip(self.handles, wrapped)]
        if self.columns == 1:
            return sum(label.count("\n") + 1 for label in wrapped)
        return math.ceil(len(labels) / self.columns)

    def save(self, form):
        handles, labels = zip(*self.handles)
        # Labels are set afterwards, because a legend leaves out those that begin with "_".
        legend = self.figure.legend(handles, [" "] * len(labels), loc="upper left", ncol=self.columns, frameon=False,
                                    borderaxespad=0, bbox_to_anchor=(0.1 / self.width, self.legend_height / self.height),
                                    title=self.heading or None, title_fontsize=7, alignment="left",
                                    handlelength=self.handle_length, labelspacing=0.3, columnspacing=1.2, borderpad=0.2)
        for text, label in zip(legend.get_texts(), labels):
            text.set(text=label, **AS_TYPED)
        legend.get_title().set(**AS_TYPED)
        return saved(self.figure, form)


def method_handles(labels, methods):
    return [(Line2D([], [], **line_style(methods.index(method))), label) for method, label in labels.items()]


def draw_curve(axes, number, points):
    style = line_style(number)
    if all(point.low is not None for point in points):
        axes.fill_between([point.seconds for point in points], [point.low for point in points],
                          [point.high for point in points], color=style["color"], alpha=0.18, linewidth=0,
                          gid=f"band-{number}")
        if len(points) == 1:  # its band has no width
            axes.plot([points[0].seconds] * 2, [points[0].low, points[0].high], color=style["color"], linewidth=1.2,
                      alpha=0.5, gid=f"bar-{number}")
    axes.plot([point.seconds for point in points], [point.error for point in points], gid=f"curve-{number}", **style)


def error_figure(curves, labels, reference, y_label, width):
    """`curves`: points by method; `reference`: the error that it resolves in the unit of the axis, or None."""
    methods = list(labels)
    drawn = {method: points for method, points in curves.items() if points}
    errors = [point.error for points in drawn.values() for point in points]
    handles = method_handles({method: labels[method] for method in drawn}, methods)
    # A reference far below all curves would squeeze them; the legend says where it lies.
    near = reference is not None and reference > min(errors) / 10
    if reference is not None:
        unit = " %" if "%" in y_label else ""
        below = "" if near else " (below the axis)"
        handles.append((Patch(facecolor=REFERENCE_GREY, edgecolor="black", linewidth=0.5),
                        f"noise of the reference: {reference:.3g}{unit}{below}"))
    sheet = Sheet(width, [0.72 * (width - LEFT)], handles)
    axes = sheet.axes[0]
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*log_limits([point.seconds for points in drawn.values() for point in points]))
    axes.set_ylim(*log_limits(errors + [reference] if near else errors))
    log_ticks(axes.xaxis, *axes.get_xlim())
    log_ticks(axes.yaxis, *axes.get_ylim())
    if near:
        axes.axhspan(axes.get_ylim()[0], reference, facecolor=REFERENCE_GREY, linewidth=0, zorder=0)
        axes.axhline(reference, color="black", linewidth=0.5, gid="reference", zorder=1)
    for method, points in drawn.items():
        draw_curve(axes, methods.index(method), points)
    axes.grid(True, which="major", color="#e8e8e8", linewidth=0.5, zorder=-1)
    axes.set_axisbelow(True)
    axes.set_xlabel("seconds")
    axes.set_ylabel(y_label)
    return sheet


def law_words(sweep):
    """The fitted slope beside the one of theory; empty without either."""
    law, words = sweep.law, []
    if law and law["exponent"] is not None:
        words.append(f"bias² ~ {sweep.parameter}^-p, p = {law['exponent']:.2f} "
                     f"({law['exponent_lo']:.2f} to {law['exponent_hi']:.2f})")
    elif law:
        words.append(f"bias² is above 0 at {law['resolved']:.0f} of {law['values']:.0f} values: no slope")
    if law and law["theory"] is not None:
        words.append(f"theory, smooth light: {law['theory']:.2f}")
    return "\n".join(words)


def draw_part(axes, points, part, look):
    """A part of the mean squared error with its band; where its interval reaches 0, a mark of its upper end."""
    shown = [(x, row) for x, row in points if row["bias_state"] != "unbiased" or part != "bias2"]
    resolved = [(x, row) for x, row in shown if row[part] > 0 and (row[part + "_lo"] is None or row[part + "_lo"] > 0)]
    bounds = [(x, row[part + "_hi"]) for x, row in shown
              if (x, row) not in resolved and row[part + "_hi"] is not None and row[part + "_hi"] > 0]
    band = [(x, row[part + "_lo"], row[part + "_hi"]) for x, row in resolved if row[part + "_lo"] is not None]
    if band:
        axes.fill_between(*zip(*band), color=look["color"], alpha=0.18, linewidth=0, gid=f"{part}-band")
    axes.plot([x for x, _ in resolved], [row[part] for _, row in resolved], gid=part, markersize=4, linewidth=1, **look)
    axes.plot([x for x, _ in bounds], [y for _, y in bounds], linestyle="none", marker="v", fillstyle="none",
              color=look["color"], markersize=4, markeredgewidth=0.6, gid=f"{part}-bounds")
    return [value for _, row in shown for value in (row[part], row[part + "_lo"], row[part + "_hi"]) if value and value > 0]


def draw_law(axes, sweep, color):
    """The fitted law of bias^2 over the points that it fits, dotted, and theory's slope through its middle."""
    law = sweep.law
    if not law or law["exponent"] is None or law.get("factor") is None:
        return
    fitted = [x for x, row in sweep.points if row["bias2_lo"] is not None and row["bias2_lo"] > 0]
    ends = [min(fitted), max(fitted)]
    middle = math.sqrt(ends[0] * ends[1])
    height = law["factor"] * middle ** -law["exponent"]
    for slope, dashes, gid in ((law["exponent"], (0, (1, 1.5)), "fit"), (law["theory"], (0, (6, 2, 1, 2)), "theory")):
        if slope is not None:
            axes.plot(ends, [height * (x / middle) ** -slope for x in ends], color=color, linewidth=0.7, linestyle=dashes, gid=gid)


def sweep_figure(sweep, component, width):
    """bias^2, variance and their sum, the mean squared error, against the parameter of a sweep, on logarithmic axes."""
    looks = {"bias2": {"color": COLORS[2], "marker": "s"}, "variance": {"color": COLORS[1], "marker": "o"}}
    handles = [(Line2D([], [], linewidth=1, markersize=4, **looks["bias2"]), "bias²"),
               (Line2D([], [], linewidth=1, markersize=4, **looks["variance"]), "variance"),
               (Line2D([], [], color="black", linewidth=0.8, linestyle="--"), "mean squared error")]
    if any(row["bias2_lo"] is not None and row["bias2_lo"] <= 0 for _, row in sweep.points):
        handles.append((Line2D([], [], linestyle="none", marker="v", fillstyle="none", color=COLORS[2], markersize=4),
                        "bias² below this"))
    if sweep.law and sweep.law["exponent"] is not None:
        handles.append((Line2D([], [], color=COLORS[2], linewidth=0.7, linestyle=(0, (1, 1.5))), "fitted bias²"))
        if sweep.law["theory"] is not None:
            handles.append((Line2D([], [], color=COLORS[2], linewidth=0.7, linestyle=(0, (6, 2, 1, 2))), "theory's slope"))
    heading = textwrap.fill(f"{sweep.name}, {component}", int(width / CHARACTER))
    law = law_words(sweep)
    left = LEFT + 0.12  # for numbers such as 3 10^-4
    sheet = Sheet(width, [0.72 * (width - left)], handles, "\n".join(part for part in (heading, law) if part), left=left)
    axes = sheet.axes[0]
    axes.yaxis.set_label_coords(-0.5 / (width - left - RIGHT), 0.5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    values = [value for part, look in looks.items() for value in draw_part(axes, sweep.points, part, look)]
    errors = [(x, max(row["bias2"], 0) + row["variance"]) for x, row in sweep.points]
    axes.plot([x for x, _ in errors], [y for _, y in errors], color="black", linewidth=0.8, linestyle="--", gid="error",
              zorder=3)
    draw_law(axes, sweep, looks["bias2"]["color"])
    axes.set_xlim(*log_limits([x for x, _ in sweep.points]))
    axes.set_ylim(*log_limits(values + [y for _, y in errors if y > 0]))
    log_ticks(axes.xaxis, *axes.get_xlim())
    log_ticks(axes.yaxis, *axes.get_ylim())
    axes.grid(True, which="major", color="#e8e8e8", linewidth=0.5, zorder=-1)
    axes.set_axisbelow(True)
    axes.set_xlabel(sweep.parameter)
    axes.set_ylabel(r"mean squared error [radiance$^2$]")
    return sheet


def style():
    """The context in which figures are made and saved; it ignores the user's own settings of matplotlib."""
    return matplotlib.rc_context({**matplotlib.rcParamsDefault, **STYLE, "backend": "agg"})
