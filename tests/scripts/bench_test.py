"""Tests of scripts/bench: figures, exponents and comparisons of Google Benchmark's JSON files with known numbers."""
import json
import os
import subprocess
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
BENCH = os.path.join(ROOT, "scripts", "bench")


def entry(name, **values):
    return {"name": name, "run_name": name, "run_type": "iteration", "real_time": 1.0, "time_unit": "ms", **values}


def aggregate(name, **values):
    return {**entry(name, **values), "name": name + "_mean", "run_type": "aggregate"}


class BenchTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def file(self, name, entries):
        path = os.path.join(self.folder.name, name)
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"benchmarks": entries}, file)
        return path

    def bench(self, *arguments, code=0):
        done = subprocess.run([BENCH, *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout if code == 0 else done.stderr

    def line(self, text, start):
        lines = [line.split() for line in text.splitlines() if line.startswith(start)]
        self.assertEqual(len(lines), 1, text)
        return lines[0]

    def compared(self, name, quantity, before, after):
        files = [self.file(f"{side}.json", [entry(name, **{quantity: value}) for value in values])
                 for side, values in (("before", before), ("after", after))]
        return self.line(self.bench("--compare", *files), name)

    def test_medians_and_spreads_leave_out_aggregates(self):
        path = self.file("a.json", [entry("BM_Walk", ratio=r) for r in (3, 1, 2)] + [aggregate("BM_Walk", ratio=100)])
        self.assertEqual(self.line(self.bench("--show", path), "BM_Walk"), "BM_Walk ratio 2 (1 to 3)".split())

    def test_times_are_in_seconds(self):
        path = self.file("a.json", [entry("BM_Write", real_time=250, time_unit="us")])
        self.assertEqual(self.line(self.bench("--show", path), "BM_Write"), "BM_Write time 0.00025".split())

    def test_exponents_follow_from_rates_and_times(self):
        entries = [entry(f"BM_Build/photons:{n}/real_time", per_second=1e12 / n**0.5) for n in (1000, 100000)]
        entries += [entry(f"BM_Cache/records:{n}", real_time=3e-3 * n**1.25) for n in (10, 100, 1000)]
        shown = self.bench("--show", self.file("a.json", entries))
        self.assertIn("BM_Build/photons:*/real_time: the time of an item grows as photons^0.50\n", shown)
        self.assertIn("BM_Cache/records:*: the time of an iteration grows as records^1.25\n", shown)

    def test_a_higher_rate_and_a_shorter_time_are_faster(self):
        faster = self.compared("BM_A", "per_second", (10, 11, 12), (20, 22, 24))
        self.assertEqual(" ".join(faster[-5:]), "2.000 (1.667 to 2.400) faster")
        self.assertEqual(self.compared("BM_B", "real_time", (10, 11, 12), (20, 22, 24))[-1], "slower")
        self.assertEqual(self.compared("BM_C", "ratio", (10, 11, 12), (20, 22, 24))[-1], "faster")

    def test_a_ratio_of_loading_times_is_faster_if_lower(self):
        self.assertEqual(self.compared("BM_LoadOverRead", "ratio", (10, 11, 12), (20, 22, 24))[-1], "slower")

    def test_runs_that_overlap_are_not_clear(self):
        self.assertEqual(self.compared("BM_A", "ratio", (10, 11, 12), (11.5, 13, 14))[-2:], ["not", "clear"])

    def test_benchmarks_of_one_file_are_named(self):
        before = self.file("a.json", [entry("BM_A", ratio=1), entry("BM_Old", ratio=1)])
        after = self.file("b.json", [entry("BM_A", ratio=1)])
        self.assertIn(f"only in {before}: BM_Old ratio", self.bench("--compare", before, after))

    def test_files_that_are_wrong_are_named(self):
        wrong = os.path.join(self.folder.name, "wrong.json")
        with open(wrong, "w", encoding="utf-8") as file:
            file.write("{}")
        self.assertIn("wrong.json: not the JSON output", self.bench("--show", wrong, code=2))
        self.assertIn("none.json: No such file", self.bench("--show", wrong.replace("wrong", "none"), code=2))
        zero = self.file("zero.json", [entry("BM_A", ratio=0)])
        self.assertIn("not a positive number", self.bench("--show", zero, code=2))
        good, other = self.file("a.json", [entry("BM_A", ratio=1)]), self.file("b.json", [entry("BM_B", ratio=1)])
        self.assertIn("b.json: has no benchmark of", self.bench("--compare", good, other, code=2))

    def test_the_number_of_runs_is_positive(self):
        self.assertIn("--runs needs a number above 0", self.bench("--runs", "0", code=2))


if __name__ == "__main__":
    unittest.main()
