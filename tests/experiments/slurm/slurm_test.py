"""Runs experiments on a cluster of one node with two CPUs: slurm_test.py GIBENCH [options of unittest].

slurmctld, slurmd and munged are those of Debian; all their files are in a temporary folder. Exit code 77: skipped.
"""
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from slurm_cluster import Cluster, missing_programs

if missing_programs():
    print(f"skipped: not installed: {', '.join(missing_programs())} "
          "(./scripts/setup scripts/packages-slurm.txt installs them)")
    sys.exit(77)

PROGRAM = os.path.abspath(sys.argv[1])
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__)))))
# Two methods, two scenes, two seeds; the references take several rounds of two makers or more.
EXPERIMENT = f"""
scenes = ["{ROOT}/scenes/cornell-box.xml", "{ROOT}/scenes/cornell-glass.xml"]
resolution = [24, 24]
seeds = 2
budget = {{ passes = 8 }}
epsilon = 0.01
[reference]
target = "4%"
[[method]]
name = "path"
[[method]]
name = "photon_mapper"
photons = 1e4
"""
# One cell of each method and seed, long enough to be ended while it runs.
LONG = f"""
scenes = ["{ROOT}/scenes/cornell-box.xml"]
resolution = [32, 32]
seeds = 4
epsilon = 0.01
[reference]
target = "10%"
[[method]]
name = "path"
spp = PASSES
"""
TIMES = ("second", "rss", "cpu")  # in the names of columns that depend on time


class SlurmTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="gibench-slurm-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, True)
        cls.cluster = Cluster(f"{cls.folder}/cluster")
        cls.addClassCleanup(cls.cluster.close)
        cls.cluster.start()

    def workplace(self, name, text):
        """A folder of its own, with its own references, that holds an experiment."""
        folder = f"{self.folder}/{name}"
        os.makedirs(folder)
        with open(f"{folder}/e.toml", "w", encoding="utf-8") as file:
            file.write(text)
        return folder

    def gibench(self, folder, *arguments, code=0):
        result = subprocess.run([PROGRAM, *arguments], cwd=folder, env=self.cluster.environment, capture_output=True,
                                text=True, check=False)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr + self.logs(folder))
        return result.stdout + result.stderr

    def logs(self, folder):
        text = ""
        for path, _, names in os.walk(f"{folder}/out/slurm"):
            for name in names:
                if name.endswith(".txt"):
                    with open(f"{path}/{name}", encoding="utf-8") as file:
                        text += f"\n{name}:\n{file.read()}"
        return text

    def submit(self, folder, *options):
        return self.gibench(folder, "run", "e.toml", "--on", "slurm", "--threads", "1", "--out", "out", *options)

    def wait(self):
        self.cluster.wait_for(lambda: not self.cluster.output("squeue", "--noheader"), "the jobs", 240)

    def counts(self, folder, code=0):
        """The numbers of `gibench status`, by their names."""
        lines = self.gibench(folder, "status", "out", code=code).splitlines()
        return dict(line.split(": ") for line in lines[:6])

    def reference(self, file):
        """SHA-1 of the pixels of all layers, and how the reference was made, without the time that it took."""
        text = subprocess.run(["oiiotool", "--info", "-v", "--hash", file], check=True, capture_output=True,
                              text=True).stdout
        kept = ("SHA-1:", "passes:", "rounds:", "makers:", "work:", "relative_error:")
        return sorted(line.strip() for line in text.splitlines() if line.strip().startswith(kept))

    def images(self, folder):
        """The digests of all images."""
        found = {}
        for path, _, names in os.walk(f"{folder}/out"):
            for name in names:
                if name == "cell.json":
                    with open(f"{path}/{name}", encoding="utf-8") as file:
                        found[os.path.basename(path)] = json.load(file)["image"]
                if name.endswith("-reference.exr"):
                    found[name] = self.reference(f"{path}/{name}")
        return found

    def table(self, folder):
        """table.csv without the columns that depend on time."""
        with open(f"{folder}/out/table.csv", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if not any(word in key for word in TIMES)}
                    for row in csv.DictReader(file)]

    def test_images_and_table_are_those_of_a_local_run(self):
        local, cluster = self.workplace("local", EXPERIMENT), self.workplace("cluster-run", EXPERIMENT)
        self.gibench(local, "run", "e.toml", "--threads", "2", "--out", "out")
        said = self.submit(cluster, "--tasks", "3")
        for job in ("batches", "references"):
            self.assertIn(f"{job}: job ", said)
        self.assertIn("makes references, and then submits the cells", self.submit(cluster))
        self.assertEqual(self.counts(cluster)["waiting"], "8")
        self.wait()
        self.assertEqual(self.counts(cluster), {"references": "2 of 2", "done": "8", "running": "0", "waiting": "0",
                                                "failed": "0", "missing": "0"})
        self.assertEqual(len(self.images(local)), 8 + 2)
        self.assertEqual(self.images(local), self.images(cluster))
        self.assertEqual(self.table(local), self.table(cluster))
        self.assertTrue(os.path.exists(f"{cluster}/out/report.html"))
        with open(f"{cluster}/out/table.csv", encoding="utf-8") as file:
            self.assertEqual({row["cpu"] != "" for row in csv.DictReader(file)}, {True})
        self.assertIn("cells: 0 complete, 0 in jobs already, 8 to be submitted", self.logs(cluster))
        self.assertIn("8 complete", self.submit(cluster))
        self.wait()

    def running(self, name="gibench-cells"):
        lines = self.cluster.output("squeue", "--array", "--noheader", "--states=RUNNING", f"--name={name}",
                                    "--format=%i").split()
        return lines

    def test_survives_a_cancelled_task_a_requeued_one_and_a_restart(self):
        text = LONG.replace("PASSES", "2000")
        local, cluster = self.workplace("long-local", text), self.workplace("long-cluster", text)
        self.submit(cluster, "--tasks", "4")
        begun = lambda: len([name for name in os.listdir(f"{cluster}/out/cells")  # noqa: E731
                             if os.path.exists(f"{cluster}/out/cells/{name}/work/request.json")]) == 2
        self.cluster.wait_for(lambda: len(self.running()) == 2 and begun(), "two running cells", 120)
        self.assertEqual(self.counts(cluster)["running"], "2")
        self.assertIn("cells: 0 complete, 4 in jobs already, 0 to be submitted", self.submit(cluster))
        self.assertIn("jobs of Slurm are working", self.gibench(cluster, "run", "e.toml", "--out", "out", code=2))
        self.cluster.stop("slurmd")
        self.cluster.start_node()
        first, second = self.running()
        self.cluster.output("scontrol", "requeue", first)
        self.cluster.output("scancel", second)
        # Slurm lets a requeued task wait for two minutes, which the test does not.
        self.cluster.wait_for(lambda: "PENDING" in self.cluster.output("squeue", "--noheader", "--array", "--format=%T",
                                                                       f"--jobs={first}"), "the requeued task")
        self.cluster.output("scontrol", "update", f"JobId={first}", "StartTime=now")
        self.wait()
        counts = self.counts(cluster, code=1)
        self.assertEqual((counts["done"], counts["missing"], counts["failed"]), ("3", "1", "0"), self.logs(cluster))
        self.assertIn("cells: 3 complete, 0 in jobs already, 1 to be submitted", self.submit(cluster))
        self.wait()
        self.assertEqual(self.counts(cluster)["done"], "4")
        self.gibench(local, "run", "e.toml", "--threads", "2", "--out", "out")
        self.assertEqual(self.images(local), self.images(cluster))

    def test_a_failed_cell_is_shown_with_its_message(self):
        # 4 % of glass-sphere takes minutes.
        folder = self.workplace("failing", EXPERIMENT.replace("cornell-glass.xml", "glass-sphere.xml").replace("4%", "40%") +
                                '[[method]]\nname = "broken"\ncommand = "echo no licence >&2; false {scene} {out}"\n')
        self.submit(folder, "--only", "broken", "--tasks", "1")
        self.wait()
        said = self.gibench(folder, "status", "out", code=1)
        self.assertIn("failed: 4\n", said)
        self.assertIn("failed: cornell-box, broken, seed 1: ", said)
        self.assertIn("no licence", said)

    def test_tasks_that_end_without_a_trace_are_told(self):
        folder = self.workplace("silent", EXPERIMENT)
        self.submit(folder, "--only", "path")
        self.wait()
        self.assertNotIn("without a trace", self.gibench(folder, "status", "out", code=1), "cells that no job has had")
        self.submit(folder, "--tasks", "8", "--sbatch", "--output=/nowhere/%A")  # Slurm ends a job whose log it cannot open
        self.wait()
        said = self.gibench(folder, "status", "out", code=1)
        self.assertIn("missing: 4\n", said)
        self.assertRegex(said, r"\n4 tasks of job \d+ ended without a trace: no cell and no log in out/slurm; `sacct")
        self.submit(folder)
        self.wait()
        self.assertNotIn("without a trace", self.gibench(folder, "status", "out"))

    def test_a_refused_job_is_an_error(self):
        folder = self.workplace("refused", EXPERIMENT)
        said = self.gibench(folder, "run", "e.toml", "--on", "slurm", "--threads", "1", "--out", "out", "--sbatch",
                            "--partition=nowhere", code=1)
        self.assertIn("partition", said)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:])
