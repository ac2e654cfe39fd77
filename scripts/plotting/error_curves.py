"""Error against time: the mean of the seeds at each pass, its 95 % band, and the noise of the reference. The
reference's own variance is subtracted, as in table.md and the report."""
import math
from dataclasses import dataclass

from plotting.result_tables import is_number, select, unique

# For each metric: column of curves.csv, whether the root of its mean is shown, factor, name on the axis.
METRICS = {
    "rel_rmse": ("rel_mse_corrected", True, 100, "relative RMSE [%]"),
    "rel_mse": ("rel_mse_corrected", False, 1, "relative MSE"),
    "rmse": ("mse_corrected", True, 1, "RMSE [radiance]"),
    "mse": ("mse_corrected", False, 1, "MSE [radiance$^2$]"),
}


@dataclass
class CurvePoint:
    seconds: float
    error: float
    low: float  # lower end of the 95 % band; None with one seed
    high: float


def two_sided_t(t, degrees):
    """The probability of |T| < t: finite sums for whole degrees of freedom (Abramowitz and Stegun 26.7.3, 26.7.4)."""
    angle = math.atan(t / math.sqrt(degrees))
    cosine2, odd = math.cos(angle) ** 2, degrees % 2
    term = math.cos(angle) if odd else 1.0
    total = 0.0 if degrees == 1 else term
    for k in range(2 + odd, degrees - 1, 2):
        term *= cosine2 * (k - 1) / k
        total += term
    total *= math.sin(angle)
    return 2 / math.pi * (angle + total) if odd else total


def t_quantile(degrees):
    """The quantile of Student's t for a two-sided 95 % interval."""
    low, high = 1.0, 16.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if two_sided_t(middle, degrees) < 0.95 else (low, middle)
    return (low + high) / 2


def mean_and_band(values):
    """(mean, low, high); low and high are None with one value or if the mean is 0. The band is symmetric in the
    logarithm, like the intervals of table.csv; those also contain the uncertainty of the reference."""
    n = len(values)
    mean = math.fsum(values) / n
    if n < 2 or mean <= 0:
        return mean, None, None
    variance = math.fsum((value - mean) ** 2 for value in values) / (n * (n - 1))
    factor = math.exp(t_quantile(n - 1) * math.sqrt(variance) / mean)
    return mean, mean / factor, mean * factor


def shown(metric, mean_square):
    """A mean square, or None, in the unit of the axis."""
    _, root, factor, _ = METRICS[metric]
    if mean_square is None:
        return None
    return factor * (math.sqrt(mean_square) if root else mean_square)


def error_curve(rows, metric):
    """The points at the passes that all seeds have, and the final images: a time budget ends seeds after different numbers
    of passes; `rows`: those of one scene and method."""
    column = METRICS[metric][0]
    rows = [row for row in rows if is_number(row[column]) and is_number(row["seconds"])]
    seeds = len(unique(row["seed"] for row in rows))
    points = []
    groups = [select(rows, **{"pass": number}) for number in sorted(unique(row["pass"] for row in rows))]
    groups = [at for at in groups if len(at) == seeds]
    last = [max(select(rows, seed=seed), key=lambda row: row["pass"]) for seed in unique(row["seed"] for row in rows)]
    if not groups or any(row not in groups[-1] for row in last):
        groups.append(last)
    for at in groups:
        seconds = math.fsum(row["seconds"] for row in at) / seeds
        band = mean_and_band([row[column] for row in at])
        if band[0] > 0 and seconds > 0:  # logarithmic axes have no place for other points
            points.append(CurvePoint(seconds, *(shown(metric, value) for value in band)))
    return points


def resolved_error(rows, metric):
    """The error below which the reference's noise hides the rest, None if unknown; `rows`: those of table.csv for one
    scene, component total. It is known for relative errors only."""
    known = [row["rel_mse_resolved"] for row in rows if is_number(row["rel_mse_resolved"])]
    if METRICS[metric][0] != "rel_mse_corrected" or not known or known[0] <= 0:
        return None
    return shown(metric, known[0])
