"""One label for each method and its name, as in table.md and the report (experiments/analysis/method_names.h)."""
from dataclasses import replace

from plotting.result_tables import select


def settings_of(method):
    return method.split(" ")[1:]


def spp_of(method):
    return next((setting for setting in settings_of(method) if setting.startswith("spp=")), None)


def split_name(row):
    """The beginning of a name, and the settings that it shows, each after its separator."""
    name, shown = row["label"] or row["method"], []
    for setting in reversed(settings_of(row["method"])):
        for separator in (", ", " "):
            if name.endswith(separator + setting):
                name = name.removesuffix(separator + setting)
                shown.insert(0, separator + setting)
                break
    return name, shown


def rows_of_longest_runs(rows):
    """Of labels that differ in `spp` alone the rows of the one with the most seeds, and among these with the most passes; of
    other renderers, whose commands start anew for each number of samples, all rows. `rows`: those of all totals."""
    groups = {}
    for row in rows:
        settings = [setting for setting in settings_of(row["method"]) if row["external"] or not setting.startswith("spp=")]
        groups.setdefault((row["scene"], row["method"].split(" ")[0], *settings), []).append(row)
    # passes: "16", or "12 to 16"
    return [max(group, key=lambda row: (row["seeds"] or 0, int(row["passes"].split(" ")[-1] or 0)))
            for group in groups.values()]


def one_label_a_method(results):
    """The results without the labels that the report leaves out, and with the names that it shows as `label`."""
    longest = rows_of_longest_runs(select(results.table, component="total"))
    kept = {(row["scene"], row["method"]) for row in longest}

    def spp_in(rows):  # by the beginning of the name
        found = {}
        for row in rows:
            found.setdefault(split_name(row)[0], set()).add(spp_of(row["method"]))
        return found
    before, after = spp_in(select(results.table, component="total")), spp_in(longest)

    def named(row):
        if not row["label"]:  # of an older version
            return row
        begin, shown = split_name(row)
        # Where no `spp` differed before, one in the name is not a setting that was appended: the label was given like that.
        merged = len(before[begin]) > 1 and len(after.get(begin, ())) < 2
        return {**row, "label": begin + "".join(text for text in shown if not (merged and text.lstrip(", ").startswith("spp=")))}

    table, curves = ([row for row in rows if (row["scene"], row["method"]) in kept] for rows in (results.table, results.curves))
    return replace(results, table=[named(row) for row in table], curves=curves)
