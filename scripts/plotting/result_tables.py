"""Reads the CSV files of a result folder whole and checks them before anything is drawn."""
import csv
import math
import os
from dataclasses import dataclass

TARGETS = ("10", "5", "2", "1", "0.5")  # relative RMSE [%] to which table.csv has times
# The columns that are used; the files have more.
CURVES = ("scene", "method", "seed", "pass", "seconds", "mse_corrected", "rel_mse_corrected")
TABLE = ("scene", "method", "label", "component", "seeds", "passes", "external", "seconds", "rel_mse",
         "rel_mse_lo", "rel_mse_hi", "rel_mse_corrected", "rel_mse_resolved", "bias2", "bias2_lo", "bias2_hi", "variance",
         "variance_lo", "variance_hi", "bias_state", "effects_missing", "components_missing", "noise_centroid", "flip",
         *(f"seconds_to_{target}pct{end}" for target in TARGETS for end in ("", "_lo", "_hi", "_state")))
BIAS_LAWS = ("scene", "method", "parameter", "component", "values", "resolved", "exponent", "exponent_lo", "exponent_hi",
             "theory", "factor")
TEXT = {"scene", "method", "label", "component", "passes", "external", "effects_missing", "components_missing", "seed", "bias_state", "parameter",
        *(f"seconds_to_{target}pct_state" for target in TARGETS)}


class InputError(Exception):
    """Names a file and says what is wrong with it."""


@dataclass
class Results:
    """Lists of rows. A row is a dict by column of texts and numbers; None if the field is empty."""
    curves: list
    table: list
    bias_laws: list


def value_of(text, column, place):
    if column in TEXT:
        return text
    if text == "":
        return None
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{place}: column '{column}': not a number: '{text}'") from None


def records_in(path):
    """Pairs of a record and the line on which it ends."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            reader = csv.reader(file, strict=True)
            return [(record, reader.line_num) for record in reader if record]
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file; `gibench report` writes it from stored results") from None
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (csv.Error, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a CSV file: {error}") from None


def read_table(path, columns):
    records = records_in(path)
    if not records:
        raise InputError(f"{path}: the file is empty")
    header = records[0][0]
    missing = [column for column in columns if column not in header]
    if missing:
        raise InputError(f"{path}: there is no column '{missing[0]}'; the columns are: {', '.join(header)}")
    rows = []
    for record, line in records[1:]:
        if len(record) != len(header):
            raise InputError(f"{path}:{line}: {len(record)} values for {len(header)} columns")
        named = dict(zip(header, record))
        rows.append({column: value_of(named[column], column, f"{path}:{line}") for column in columns})
    return rows


def read_results(folder):
    """Raises InputError."""
    if not os.path.isdir(folder):
        raise InputError(f"{folder}: there is no such folder")

    def table(name, columns):
        return read_table(os.path.join(folder, name), columns)

    results = Results(table("curves.csv", CURVES), table("table.csv", TABLE),
                      # Older folders have no such file.
                      table("bias_laws.csv", BIAS_LAWS) if os.path.exists(os.path.join(folder, "bias_laws.csv")) else [])
    for name, rows in (("curves.csv", results.curves), ("table.csv", results.table)):
        if not rows:
            raise InputError(f"{os.path.join(folder, name)}: the table has no rows")
    return results


def unique(values):
    return list(dict.fromkeys(values))


def select(rows, **wanted):
    return [row for row in rows if all(row[column] == value for column, value in wanted.items())]


def is_number(value):
    return value is not None and math.isfinite(value)


def labels_of(rows):
    """The name of each method, by its label with all settings, in the order of the rows of table.csv."""
    return {row["method"]: row["label"] or row["method"] for row in rows}
