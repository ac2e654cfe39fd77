"""Tests of scripts/gibench.py with a small experiment: numbers against the CSV files, layers against oiiotool and their sum.
Usage: gibench_py_test.py GIBENCH. Exit code 77: skipped."""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts"))
try:
    import numpy
    import OpenImageIO
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
import gibench  # noqa: E402  found by the line above

PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else gibench.PROGRAM
EXPERIMENT = """
scenes = ["{root}/scenes/cornell-box.xml"]
resolution = [16, 12]
seeds = 2
budget = {{ passes = 2 }}
reference = {{ target = "50%" }}
[[method]]
name = "path"
label = "paths, 2 of them"
"""


class Module(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.parent = tempfile.TemporaryDirectory()
        cls.folder = os.path.join(cls.parent.name, "out")
        cls.experiment = os.path.join(cls.parent.name, "e.toml")
        with open(cls.experiment, "w", encoding="utf-8") as file:
            file.write(EXPERIMENT.format(root=ROOT))
        before = os.getcwd()
        os.chdir(cls.parent.name)  # results/references
        try:
            cls.returned = gibench.run(cls.experiment, "--threads", "1", out=cls.folder, program=PROGRAM)
        finally:
            os.chdir(before)

    @classmethod
    def tearDownClass(cls):
        cls.parent.cleanup()

    def test_run_returns_the_folder_of_the_results(self):
        self.assertEqual(self.returned, self.folder)
        self.assertTrue(os.path.exists(os.path.join(self.folder, "report.html")))

    def test_unlike_quantities_of_two_folders_are_named(self):
        self.assertEqual(gibench.unlike(self.folder, self.folder), {})
        with tempfile.TemporaryDirectory() as other:
            with open(os.path.join(self.folder, "manifest.json"), encoding="utf-8") as file:
                manifest = json.load(file)
            quantities = manifest["scenes"][0]["quantities"]
            before = quantities["epsilon"]
            quantities["epsilon"] = "0.1"
            del quantities["unit"]  # a version that does not know it
            with open(os.path.join(other, "manifest.json"), "w", encoding="utf-8") as file:
                json.dump(manifest, file)
            self.assertEqual(gibench.unlike(self.folder, other), {"cornell-box": {"epsilon": (before, "0.1")}})

    def test_table_has_every_row_with_its_numbers(self):
        rows = gibench.table(self.folder)
        with open(os.path.join(self.folder, "table.csv"), encoding="utf-8", newline="") as file:
            records = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(records))
        for row, record in zip(rows, records):
            self.assertEqual(row["method"], "path")
            self.assertEqual(row["label"], "paths, 2 of them")
            self.assertEqual(row["rel_mse"], float(record["rel_mse"]) if record["rel_mse"] else None)
            self.assertIsNone(row["effects_missing"])
        self.assertEqual([row["pass"] for row in gibench.table(self.folder, "curves.csv")], [1, 2, 1, 2])

    def test_layers_are_those_of_the_file(self):
        name = next(n for n in os.listdir(os.path.join(self.folder, "images")) if n.endswith(".exr") and "reference" not in n)
        path = os.path.join(self.folder, "images", name)
        layers = gibench.layers(path)
        self.assertEqual(layers[""].shape, (12, 16, 3))
        self.assertEqual(layers[""].dtype, numpy.float32)
        parts = [layer for name, layer in layers.items() if name]
        self.assertGreater(len(parts), 2)
        numpy.testing.assert_allclose(sum(parts), layers[""], rtol=1e-5, atol=1e-6)
        said = subprocess.run(["oiiotool", "--dumpdata", path], capture_output=True, text=True, check=True)
        pixel = next(line for line in said.stdout.splitlines() if "(3, 5)" in line)  # column 3, row 5 from the top
        numbers = [float(word) for word in pixel.split(":")[-1].split()]
        self.assertTrue(any(abs(number - layers[""][5, 3, 1]) < 1e-5 for number in numbers), pixel)
        self.assertIn("stderr", gibench.layers(os.path.join(self.folder, "images", "cornell-box-reference.exr")))

    def written(self, name, values, channels, **window):
        """The path of an image of these values, height x width x channels."""
        path = os.path.join(self.parent.name, name)
        spec = OpenImageIO.ImageSpec(values.shape[1], values.shape[0], len(channels), "float")
        spec.channelnames = channels
        for key, value in window.items():
            setattr(spec, key, value)
        file = OpenImageIO.ImageOutput.create(path)
        self.assertTrue(file.open(path, spec), file.geterror())
        self.assertTrue(file.write_image(numpy.asarray(values, dtype=numpy.float32)))
        file.close()
        return path

    def layers_of(self, *channels):
        """The layers of a pixel with the values 0, 1, 2, ..."""
        values = numpy.tile(numpy.arange(len(channels), dtype=numpy.float32), (1, 2, 1))
        return gibench.layers(self.written("channels.exr", values, channels))

    def compare(self, *arguments):
        return subprocess.run([PROGRAM, "compare", *arguments], capture_output=True, text=True, check=False)

    def test_layers_may_have_small_letters_or_luminance_alone(self):
        self.assertEqual(self.layers_of("r", "g", "b")[""][0, 0].tolist(), [0, 1, 2])
        self.assertEqual(self.layers_of("Z", "Y")[""][0, 0].tolist(), [1, 1, 1])
        only = self.layers_of("View.R", "View.G", "View.B")
        self.assertEqual(only[""].tolist(), only["View"].tolist())
        with self.assertRaisesRegex(OSError, "no layer of R, G, B or Y; its channels are: A, Z"):
            self.layers_of("A", "Z")

    def test_xyz_is_converted_as_compare_does(self):
        values = numpy.random.default_rng(1).uniform(0.2, 1, (16, 16, 3)).astype(numpy.float32)
        xyz = self.written("xyz.exr", values, ("X", "Y", "Z"))
        rgb = self.written("rgb.exr", gibench.layers(xyz)[""], ("R", "G", "B"))
        said = self.compare("--json", rgb, xyz)
        self.assertLess(json.loads(said.stdout)["rel_rmse"], 1e-6, said.stderr)
        self.assertEqual(list(self.layers_of("N.x", "N.y", "N.z", "R", "G", "B")), [""], "a normal is no colour")

    def test_eight_bits_are_linear(self):
        self.assertAlmostEqual(float(gibench.layers(self.written("half.png", numpy.full((1, 1, 3), 0.5), ("R", "G", "B")))[""][0, 0, 0]),
                               0.2140, delta=0.002)

    def test_overscan_is_left_out(self):
        values = numpy.arange(6 * 4 * 3, dtype=numpy.float32).reshape(6, 4, 3)
        path = self.written("overscan.exr", values, ("R", "G", "B"), x=-1, y=-2, full_x=0, full_y=0, full_width=2, full_height=3)
        self.assertEqual(gibench.layers(path)[""].tolist(), values[2:5, 1:3].tolist())

    def test_what_compare_refuses_is_refused(self):
        values = numpy.random.default_rng(1).uniform(0.2, 1, (64, 64, 3)).astype(numpy.float32)
        whole = self.written("whole.exr", values, ("R", "G", "B"))
        cut = os.path.join(self.parent.name, "cut.exr")
        with open(whole, "rb") as file, open(cut, "wb") as other:
            content = file.read()
            other.write(content[:len(content) // 2])
        parts = os.path.join(self.parent.name, "parts.exr")
        subprocess.run(["oiiotool", whole, whole, "--siappend", "-o", parts], check=True)
        cropped = self.written("cropped.exr", values, ("R", "G", "B"), full_width=80, full_height=64)
        chroma = self.written("chroma.exr", values, ("BY", "RY", "Y"))
        half = self.written("half.exr", values, ("R", "G", "caustic.R"))
        for path, message in ((cut, "damaged"), (parts, "several parts"), (cropped, "cropped"), (chroma, "no layer of R, G, B or Y"),
                              (half, "the layer '' has channels G, R, but not all|the layer '' has channels R, G, but not all")):
            self.assertEqual(self.compare(path, whole).returncode, 2, path)
            with self.assertRaisesRegex(OSError, message):
                gibench.layers(path)

    def test_plot_draws_the_images_with_crops(self):
        def plot(*options):
            return subprocess.run([os.path.join(ROOT, "scripts", "plot"), self.folder, "--images", "--format", "png", *options],
                                  capture_output=True, text=True, check=False)
        run = plot("--crop", "2,3,4,5")
        if "matplotlib" in run.stderr:
            self.skipTest("matplotlib")
        self.assertEqual(run.returncode, 0, run.stderr)
        figure = gibench.layers(os.path.join(self.folder, "figures", "images-cornell-box.png"))[""]
        self.assertGreater(len(numpy.unique(figure)), 20)
        with open(os.path.join(self.folder, "figures", "images-cornell-box.tex"), encoding="utf-8") as file:
            caption = file.read()
        self.assertIn(r"\includegraphics[width=\linewidth]{images-cornell-box.png}", caption)
        # The image is one of seed 1: after the mean time of all seeds, it may be that of the first pass.
        errors = [row["rel_mse_corrected"] for row in gibench.table(self.folder, "curves.csv") if row["seed"] == 1]
        self.assertTrue(any(f"paths, 2 of them: {f'{100 * error ** 0.5:#.3g}'.rstrip('.')} \\%" in caption for error in errors),
                        caption)
        self.assertEqual(plot("--method", "paths, 2 of them").returncode, 0)
        for options, message in ((("--crop", "9,0,8,8"), "exceeds the image of 16 x 12"), (("--crop", "1,2"), "X,Y,W,H"),
                                 (("--method", "vcm"), "there is no method of cornell-box 'vcm'")):
            run = plot(*options)
            self.assertEqual(run.returncode, 2)
            self.assertIn(message, run.stderr)

    def test_the_notebook_makes_three_figures(self):
        try:
            import matplotlib
        except ImportError as error:
            self.skipTest(str(error))
        matplotlib.use("agg")
        from matplotlib import pyplot
        sweep = os.path.join(self.parent.name, "sweep.toml")
        with open(sweep, "w", encoding="utf-8") as file:
            file.write(EXPERIMENT.format(root=ROOT) + 'spp = 2\n[[method]]\nname = "photon_mapper"\nphotons = [100, 300, 1000]\nspp = 2\n')
        with open(os.path.join(ROOT, "scripts", "figures.ipynb"), encoding="utf-8") as file:
            cells = [cell for cell in json.load(file)["cells"] if cell["cell_type"] == "code"]
        self.assertEqual([cell["outputs"] for cell in cells], [[]] * len(cells), "without outputs")
        before, names = os.getcwd(), {}
        with unittest.mock.patch.object(gibench, "ROOT", self.parent.name), \
                unittest.mock.patch.object(gibench.run, "__kwdefaults__", {"out": None, "program": PROGRAM}):
            try:
                for cell in cells:
                    exec("".join(cell["source"]), names)  # pylint: disable=exec-used
                    if "EXPERIMENTS" in names:
                        names["EXPERIMENTS"] = sweep, sweep
            finally:
                os.chdir(before)
        curves, bias, images = (pyplot.figure(number).axes for number in pyplot.get_fignums())
        self.assertEqual([len(line.get_xdata()) for line in curves[0].lines], [2, 2, 2, 2], "passes of four methods")
        rows = {row["method"]: row for row in gibench.table(os.path.join(self.parent.name, "results", "sweep"))
                if row["component"] == bias[0].get_title().split(", ")[1]}
        for line, column in zip(bias[0].lines, ("bias2", "variance")):
            self.assertEqual(list(line.get_xdata()), [100, 300, 1000])
            self.assertEqual(list(line.get_ydata()), [rows[f"photon_mapper photons={n} spp=2"][column] for n in (100, 300, 1000)])
        self.assertEqual([len(axes.images) for axes in images], [1] * 5, "the reference and four methods")

    def test_a_missing_file_is_named(self):
        with self.assertRaisesRegex(OSError, "nothing.exr"):
            gibench.layers(os.path.join(self.folder, "nothing.exr"))


if __name__ == "__main__":
    unittest.main()
