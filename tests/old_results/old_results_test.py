"""Results of an earlier version (commit b95cb83b) are read by today's program, and by scripts/gibench.py.
`gibench run box.toml --threads 1` made them in a copy of this folder. Hard links became symbolic ones; report.html and table.md,
which nothing reads, were left out. If a column, a record or a key changes so that a test fails here, users' folders change
too: the change is a decision, which edits the test.
Usage: old_results_test.py GIBENCH"""
import csv
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(HERE)), "scripts"))
import gibench  # noqa: E402  found by the line above

PROGRAM = os.path.abspath(sys.argv.pop()) if len(sys.argv) > 1 else gibench.PROGRAM
TABLES = ("table.csv", "curves.csv", "spectra.csv", "stages.csv", "bias_laws.csv")
# Columns that have gone since: no document and no script named them, or two others say the same.
GONE = {"table.csv": "law_.*|(last|next)_halving.*|seconds_to_.*_law.*|rel_mse_(corrected_lo|corrected_hi|median|trimmed|top_share)",
        "curves.csv": "spp|rmse"}
# Numbers that were measured or follow from what was, without a fit or a resampling, and words.
MEASURED = ("seeds", "seconds", "rmse", "rel_mse", "rmse_corrected", "bias2", "variance", "nonfinite", "peak_rss_mib", "flip",
            "epsilon", "passes", "effects_missing", "components_missing", "cpu", "label")


def read(path, reader=lambda file: file.read()):
    with open(path, encoding="utf-8") as file:
        return reader(file)


class OldResults(unittest.TestCase):
    def setUp(self):
        parent = tempfile.TemporaryDirectory()
        self.addCleanup(parent.cleanup)
        self.folder = os.path.join(parent.name, "copy")
        shutil.copytree(HERE, self.folder)  # it copies what the links name
        self.results = os.path.join(self.folder, "results", "box")

    def gibench(self, *arguments, codes=(0,)):
        """What the program prints, and what it says on stderr."""
        done = subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertIn(done.returncode, codes, done.stderr)
        return done.stdout, done.stderr

    def cells(self):
        """The records of the cells by the names of their folders."""
        cells = os.path.join(self.results, "cells")
        return {name: read(os.path.join(cells, name, "cell.json")) for name in os.listdir(cells)}

    def edit(self, path, old, new):
        path = os.path.join(self.folder, path)
        text = read(path)
        self.assertIn(old, text)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace(old, new, 1))

    def assert_same_rows(self, name, columns):
        """The rows of a table are those of the old one; numbers differ by rounding only."""
        old, new = (gibench.table(os.path.join(folder, "results", "box"), name) for folder in (HERE, self.folder))
        self.assertEqual(len(new), len(old), name)
        for before, after in zip(old, new):
            for column in columns:
                a, b = before[column], after[column]
                same = math.isclose(a, b, rel_tol=1e-6) if isinstance(a, float) and isinstance(b, float) else a == b
                self.assertTrue(same, f"{name}, {before['method']}, {column}: {a}, now {b}")

    def test_a_report_has_the_old_columns_and_numbers(self):
        _, said = self.gibench("report", "results/box")
        self.assertNotIn("warning", said)
        for name in TABLES:
            old, new = (read(os.path.join(folder, "results", "box", name), lambda file: next(csv.reader(file)))
                        for folder in (HERE, self.folder))
            lost = [column for column in old if column not in new and not re.fullmatch(GONE.get(name, ""), column)]
            self.assertEqual(lost, [], f"columns of {name} that are lost")
        self.assert_same_rows("table.csv", ("scene", "method", "component", *MEASURED))
        self.assert_same_rows("curves.csv", ("scene", "method", "seed", "pass", "seconds", "rel_mse", "peak_rss_mib"))
        self.assert_same_rows("stages.csv", ("scene", "method", "seed", "stage", "seconds"))
        self.assert_same_rows("spectra.csv", ("scene", "method", "kind", "component", "frequency", "power"))
        self.assertIn("radiosity, coarse", read(os.path.join(self.results, "report.html")))

    def test_a_run_goes_on_from_them(self):
        before = self.cells()
        _, said = self.gibench("run", "box.toml", "--threads", "1", "--seeds", "4")
        self.assertIn("(stored)", said, "the reference is kept")
        self.assertIn("cells complete already, not done again: 6\n", said)
        after = self.cells()
        self.assertEqual({name: after[name] for name in before}, before)
        self.assertEqual(len(after), 8, "a fourth seed of both methods")
        self.assertEqual(len(gibench.table(self.results)), len(gibench.table(os.path.join(HERE, "results", "box"))))

    def test_a_better_reference_goes_on_from_the_old_one(self):
        self.edit("box.toml", '"30%"', '"0.6%"')
        before = self.cells()
        _, said = self.gibench("run", "box.toml", "--threads", "1")
        self.assertIn("cells measured before with another scene file, reference, budget,", said, "why they are done again")
        self.assertEqual(self.cells().keys(), before.keys())
        then, now = (read(os.path.join(folder, "results", "box", "index.json"), json.load)["scenes"][0]
                     for folder in (HERE, self.folder))
        (key, passes), (new_key, new_passes) = then["reference"].split(":"), now["reference"].split(":")
        self.assertEqual(new_key, key)
        self.assertGreater(int(new_passes), int(passes))
        self.assertNotIn("made again", said)

    def test_status_counts_every_cell_as_done(self):
        self.assertIn("references: 1 of 1\ndone: 6\n", self.gibench("status", "results/box")[0])

    def test_they_compare_with_themselves_and_with_a_fresh_run(self):
        compared, _ = self.gibench("compare-runs", "results/box", "results/box")
        self.assertIn("25.07 % -> 25.07 %", compared)
        self.assertRegex(compared, r"\n\d numbers: 0 better, 0 worse")  # more where the machine was busy
        self.gibench("run", "box.toml", "--threads", "1", "--out", "results/fresh")
        # Machines differ in speed, so that the runs need not have a time in common; but they have the same scene and methods.
        compared, _ = self.gibench("compare-runs", "results/box", "results/fresh")
        for difference in ("only in the", "has changed", "settings differ"):
            self.assertNotIn(difference, compared)

    def test_they_are_repeated(self):
        # Images on another machine may differ in their last bits, which is exit code 1.
        printed, _ = self.gibench("run", "--repeat", "results/box", codes=(0, 1))
        self.assertNotIn("not repeated", printed)
        self.assertIn(" of 6 identical\n", printed)

    def test_results_of_another_format_are_refused(self):
        other = '"gibench results 2"'
        self.edit("results/box/manifest.json", "{", f'{{"format": {other},\n')
        self.assert_refused(f"results/box/manifest.json:1:1: the results are of another format, {other}, ")
        shutil.copy(os.path.join(HERE, "results", "box", "manifest.json"), self.results)
        self.edit("results/box/index.json", '"gibench results 1"', other)
        self.assert_refused(f"results/box/index.json:1:1: the results are of another format, {other}, ")

    def assert_refused(self, message):
        for command in (["report", "results/box"], ["status", "results/box"], ["compare-runs", "results/box", "results/box"],
                        ["run", "box.toml", "--threads", "1"], ["run", "--repeat", "results/box"]):
            _, said = self.gibench(*command, codes=(2,))
            last = said.splitlines()[-1]
            self.assertTrue(last.startswith(message), said)
            self.assertNotIn(". ", last, "one sentence")

    def test_the_module_reads_tables_and_images(self):
        rows = {(row["method"], row["component"]): row for row in gibench.table(self.results)}
        self.assertEqual(rows["path spp=2", "caustic"]["rel_mse"], 7.26070035e-05)
        self.assertEqual(rows["radiosity patch=0.3 spp=2", "total"]["effects_missing"], "specular_reflection;refraction;caustics")
        self.assertNotIn(("radiosity patch=0.3 spp=2", "caustic"), rows)
        try:
            import numpy  # noqa: F401
            import OpenImageIO  # noqa: F401
        except ImportError as error:
            self.skipTest(str(error))
        images = os.path.join(self.results, "images")
        self.assertEqual(gibench.layers(os.path.join(images, "box-path_spp=2.exr")).keys(),
                         {"", "emission", "direct", "caustic", "indirect", "volume"})
        self.assertNotIn("caustic", gibench.layers(os.path.join(images, "box-radiosity_patch=0.3_spp=2.exr")))
        reference = gibench.layers(os.path.join(images, "box-reference.exr"))
        self.assertEqual(reference["caustic_stderr"].shape, (2, 3, 3))


if __name__ == "__main__":
    unittest.main()
