"""Makes a LaTeX table of one scene, which a document reads by \\input. It needs the package booktabs."""
import math

from plotting.result_tables import TARGETS, is_number, labels_of

ESCAPES = {"\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%",
           "_": r"\_", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}",
           ">": r"\textgreater{}", "|": r"\textbar{}"}
NONE = "---"


def escaped(text):
    return "".join(ESCAPES.get(character, character) for character in text)


def number(value):
    """Three significant digits, with powers of ten where table.md has them."""
    if value == 0:
        return "0"
    size = abs(value)
    if size < 1e-3 or size >= 1e5:
        return power(value)
    decimals = 0 if size >= 100 else 1 if size >= 10 else 2 if size >= 1 else 3 if size >= 0.1 else 4
    return f"{value:.{decimals}f}"


def power(value):
    """Three significant digits with a power of ten, so that all numbers of a column look alike."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return rf"${mantissa}\times10^{{{int(exponent)}}}$" if value else "0"


def optional(value):
    return number(value) if is_number(value) else NONE


def bias2(row):
    """0 by theory; below the upper end of its interval where this reaches 0; else the estimate."""
    value, low, high = row["bias2"], row["bias2_lo"], row["bias2_hi"]
    if row["bias_state"] == "unbiased":
        return "unbiased"
    if is_number(low) and is_number(high) and low <= 0:
        return rf"$<${power(high)}"
    return power(max(0.0, value)) if is_number(value) else NONE


def time(row, column):
    """The time to an error, or what is known of it."""
    state, low, high = (row[column + end] for end in ("_state", "_lo", "_hi"))
    if state == "extrapolated" and is_number(low) and is_number(high):
        return f"{number(low)}--{number(high)} (extrapolated)"
    if state == "at least" and is_number(low):
        return f"at least {number(low)} (extrapolated)"
    if state == "some seeds":
        return "not by all seeds"
    return number(row[column]) if is_number(row[column]) else state or NONE


def percent(rel_mse):
    return f"{100 * math.sqrt(max(0.0, rel_mse)):.2f}"


def relative_rmse(row):
    """The relative RMSE [%] with its interval, the reference's own variance subtracted: the number of table.md."""
    value, plain_value, low, high = (row[column] for column in ("rel_mse_corrected", "rel_mse", "rel_mse_lo", "rel_mse_hi"))
    if not is_number(value):
        return NONE
    resolved = row["rel_mse_resolved"]
    if is_number(resolved) and value <= resolved:
        return rf"$<${percent(resolved)}"
    if is_number(plain_value) and is_number(low) and is_number(high):
        own = plain_value - value  # the reference's variance
        return f"{percent(value)} ({percent(low - own)}--{percent(high - own)})"
    return percent(value)


def left_out(row):
    """The effects and the light that a method leaves out, as in table.md."""
    effects, light = (row[name].replace(";", ", ").replace("_", " ") for name in ("effects_missing", "components_missing"))
    return "; ".join(part for part in (effects, f"light of {light}" if light else "") if part)


def plain(column):
    return lambda row: optional(row[column])


# Head and cell of each column, by the names that --columns takes: those of table.csv, but for the first and the last.
COLUMNS = {
    "rel_rmse": (r"relative RMSE [\%]", relative_rmse),
    "seconds": ("time [s]", plain("seconds")),
    "bias2": ("bias$^2$ [radiance$^2$]", bias2),
    "variance": ("variance [radiance$^2$]", lambda row: power(row["variance"]) if is_number(row["variance"]) else NONE),
    **{f"seconds_to_{target}pct": (rf"time to {target}\,\% [s]", lambda row, target=target: time(row, f"seconds_to_{target}pct"))
       for target in TARGETS},
    "noise_centroid": ("noise centroid [cycles/pixel]", plain("noise_centroid")),
    "flip": ("FLIP", plain("flip")),
    "left_out": ("left out", lambda row: escaped(left_out(row))),
}
USUAL = ("seconds", "rel_rmse", "bias2", "variance", "seconds_to_5pct", "seconds_to_2pct", "seconds_to_1pct")


def latex_table(rows, scene, component, columns=None):
    """The table as text; `rows`: those of table.csv for one scene and component. `columns`: names in COLUMNS; None: the usual
    ones, and `left_out` if a method leaves out anything."""
    labels = labels_of(rows)
    columns = columns or (*USUAL, *(["left_out"] if any(left_out(row) for row in rows) else []))
    letters = "l" + "".join("l" if column == "left_out" else "r" for column in columns)
    heads = ["method", *(COLUMNS[column][0] for column in columns)]
    comment = f"% Scene {scene}, component {component}; needs \\usepackage{{booktabs}}.".replace("\n", " ")
    settings = [f"% {name}: {method}".replace("\n", " ") for method, name in labels.items() if name != method]
    lines = [comment, *settings, rf"\begin{{tabular}}{{@{{}}{letters}@{{}}}}", r"  \toprule", "  " + " & ".join(heads) + r" \\",
             r"  \midrule"]
    for row in rows:
        cells = [rf"\texttt{{{escaped(labels[row['method']])}}}", *(COLUMNS[column][1](row) for column in columns)]
        lines.append("  " + " & ".join(cells) + r" \\")
    return "\n".join([*lines, r"  \bottomrule", r"\end{tabular}", ""])
