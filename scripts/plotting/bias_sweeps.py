"""Finds the rows of table.csv that differ in one parameter alone."""
from dataclasses import dataclass, field

from plotting.method_names import split_name
from plotting.result_tables import is_number, select, unique


@dataclass
class Sweep:
    """`points`: (x, row of table.csv) by x; `name`: of the method without the parameter; `law`: the row of bias_laws.csv, or
    None."""
    method: str
    name: str
    parameter: str
    points: list = field(default_factory=list)
    law: dict = None


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def sweeps_of(rows, laws):
    """The sweeps with three values or more among the rows of one scene and component, but those of unbiased methods."""
    found = {}
    for row in rows:
        if not is_number(row["variance"]):
            continue
        words = row["method"].split(" ")
        for place, word in enumerate(words[1:], 1):
            parameter, _, value = word.partition("=")
            x = number(value)
            if x is not None and x > 0 and parameter != "spp":
                method = " ".join(words[:place] + words[place + 1:])
                found.setdefault((method, parameter), {})[x] = row
    sweeps = []
    for (method, parameter), points in found.items():
        if len(points) < 3 or all(row["bias_state"] == "unbiased" for row in points.values()):
            continue
        law = select(laws, method=method, parameter=parameter)
        row = next(iter(points.values()))
        begin, shown = split_name(row) if row["label"] else (method, [])
        name = begin + "".join(text for text in shown if not text.lstrip(", ").startswith(parameter + "="))
        sweeps.append(Sweep(method, name, parameter, sorted(points.items(), key=lambda point: point[0]), law[0] if law else None))
    return sweeps


def component_of_largest_bias(rows, default="total"):
    """The component, other than the total, whose resolved bias^2 is largest in any row."""
    def largest(component):
        return max((row["bias2"] for row in select(rows, component=component)
                    if is_number(row["bias2"]) and is_number(row["bias2_lo"]) and row["bias2_lo"] > 0), default=0)
    components = [name for name in unique(row["component"] for row in rows) if name != "total"]
    best = max(components, key=largest, default=default)
    return best if components and largest(best) > 0 else default
