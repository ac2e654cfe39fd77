"""Tests of scripts/plot: the figures against the CSV files, the LaTeX table, errors. Exit code 77: skipped."""
import importlib.util
import json
import math
import os
import re
import shutil
import sys
import tempfile
import unittest

from plot_fixtures import CURVES, LAWS, METHODS, PLOT, SWEEP, Svg, TABLE, content, plot, result_folder
from plotting import bias_sweeps, error_curves, latex, method_names, result_tables  # found by the line above


class PlotTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.parent = tempfile.TemporaryDirectory()
        cls.folder = result_folder(cls.parent.name)
        cls.made = plot(cls.folder, PYTHONHASHSEED="1")
        cls.out = os.path.join(cls.folder, "figures")

    @classmethod
    def tearDownClass(cls):
        cls.parent.cleanup()

    def svg(self, kind):
        return Svg(os.path.join(self.out, f"{kind}-box.svg"))

    def assert_close(self, found, expected, relative=1e-3):
        self.assertEqual(len(found), len(expected))
        for one, other in zip(found, expected):
            self.assertLess(abs(one - other), relative * abs(other) + 1e-9, f"{found} instead of {expected}")

    def test_makes_every_figure_in_every_format(self):
        self.assertEqual((self.made.returncode, self.made.stderr), (0, ""))
        names = ["error-box.pdf", "error-box.png", "error-box.svg", "table-box.tex"]
        self.assertEqual(sorted(os.listdir(self.out)), names)
        self.assertEqual(sorted(self.made.stdout.split("\n")[:-1]), [os.path.join(self.out, name) for name in names])

    def test_same_data_give_the_same_bytes(self):
        again = os.path.join(self.parent.name, "again")
        self.assertEqual(plot(self.folder, "--out", again, PYTHONHASHSEED="2", SOURCE_DATE_EPOCH="0").returncode, 0)
        first, second = content(self.out), content(again)
        self.assertEqual([name for name in first if first[name] != second.get(name)], [])
        self.assertNotRegex(first["error-box.svg"], b"<dc:date>")
        self.assertNotIn(b"CreationDate", first["error-box.pdf"])

    def test_pdf_has_text_as_outlines_of_truetype_and_the_asked_width(self):
        pdf = content(self.out)["error-box.pdf"]
        self.assertIn(b"/CIDFontType2", pdf)
        self.assertNotIn(b"/Type3", pdf)
        self.assertRegex(pdf, rb"/MediaBox \[ 0 0 252 ")

    def test_curves_lie_where_the_numbers_are(self):
        svg = self.svg("error")
        seconds, error = svg.axis(1, "x", True), svg.axis(1, "y", True)
        for m in (0, 1):
            marks = svg.marks(f"curve-{m}")
            self.assert_close([seconds(x) for x, _ in marks], [(1 + m) * number for number in (1, 2, 4, 16)])
            self.assert_close([error(y) for _, y in marks], [40, 40 / math.sqrt(2), 20, 10])
        self.assertIn("relative RMSE [%]", svg.text())
        for method in METHODS:
            self.assertIn(method, svg.text())

    def test_bands_are_those_of_students_t(self):
        # The scatter is 0.25 of the mean of 3 seeds: the squared error gets the factor exp(t_2 0.25 / sqrt(3)), the
        # error its root.
        factor = math.exp(4.302653 * 0.25 / math.sqrt(3) / 2)
        svg = self.svg("error")
        seconds, error = svg.axis(1, "x", True), svg.axis(1, "y", True)
        at_2 = [error(y) for x, y in svg.band("band-0") if abs(seconds(x) - 2) < 0.01]
        self.assert_close([max(at_2), min(at_2)], [40 / math.sqrt(2) * factor, 40 / math.sqrt(2) / factor])

    def test_the_reference_error_is_a_floor(self):
        svg = self.svg("error")
        height = {y for _, y in svg.corners("reference")}
        self.assertEqual(len(height), 1)
        self.assert_close([svg.axis(1, "y", True)(height.pop())], [100 * math.sqrt(0.01 - 0.0096)])
        self.assertIn("noise of the reference: 2 %", svg.text())

    def test_component_format_width_and_metric_are_obeyed(self):
        out = os.path.join(self.parent.name, "options")
        run = plot(self.folder, "--out", out, "--format", "svg", "--component", "direct", "--width", "72.27mm")
        self.assertEqual(run.returncode, 0)
        self.assertEqual(sorted(os.listdir(out)), ["table-box-direct.tex"])
        self.assertIn("no error figure: curves.csv has no components", run.stderr)
        direct = content(out)["table-box-direct.tex"]
        self.assertIn(b"1.50 & not reached & below the reference's noise", direct)
        self.assertIn(b"& unbiased &", direct)
        self.assertIn(b"& $<$10.00 &", direct, "its error is not resolved")

    def test_latex_has_the_numbers(self):
        lines = content(self.out)["table-box.tex"].decode().split("\n")
        rows = [line.strip() for line in lines if line.startswith(r"  \texttt")]
        self.assertEqual(rows, [
            r"\texttt{path spp=4} & 16.0 & 10.00 (9.00--11.00) & $<$$3.00\times10^{-5}$ & $1.23\times10^{-3}$ & 3.46 & "
            r"20.0--25.0 (extrapolated) & at least 88.0 (extrapolated) &  \\",
            r"\texttt{photon\_mapper photons=1e4 \& 50\%} & 32.0 & 10.00 (9.00--11.00) & $2.00\times10^{-4}$ & "
            r"$1.23\times10^{-4}$ & 12.3 & $1.23\times10^{6}$ & never & caustics, glossy lobes; light of caustic, indirect \\"])
        self.assert_columns_fit(lines)

    def assert_columns_fit(self, lines):
        columns = re.search(r"@\{\}(\w+)@\{\}", lines[1])[1]
        for line in lines:
            if line.endswith(r"\\"):
                self.assertEqual(len(re.findall(r"(?<!\\)&", line)) + 1, len(columns), line)

    def test_latex_has_the_chosen_columns_in_their_order(self):
        out = os.path.join(self.parent.name, "columns")
        run = plot(self.folder, "--out", out, "--format", "svg", "--columns", "variance,left_out,rel_rmse")
        self.assertEqual(run.returncode, 0, run.stderr)
        lines = content(out)["table-box.tex"].decode().split("\n")
        self.assertIn(r"  \texttt{path spp=4} & $1.23\times10^{-3}$ &  & 10.00 (9.00--11.00) \\", lines)
        self.assertIn(r"  method & variance [radiance$^2$] & left out & relative RMSE [\%] \\", lines)
        self.assert_columns_fit(lines)
        for name, (_, cell) in latex.COLUMNS.items():
            self.assertIsInstance(cell(result_tables.read_results(self.folder).table[0]), str, name)


class PartsTest(unittest.TestCase):
    def test_quantiles_are_the_tables(self):
        for degrees, t in ((1, 12.7062), (2, 4.3027), (3, 3.1824), (4, 2.7764), (9, 2.2622), (30, 2.0423)):
            self.assertAlmostEqual(error_curves.t_quantile(degrees), t, places=4)

    def test_passes_of_all_seeds_and_the_final_images_make_points(self):
        rows = [{"seed": seed, "pass": number, "seconds": number, "mse_corrected": 4.0}
                for seed, number in (("1", 1.0), ("2", 1.0), ("1", 2.0))]
        self.assertEqual([point.seconds for point in error_curves.error_curve(rows, "rmse")], [1.0, 1.5])
        self.assertEqual([point.error for point in error_curves.error_curve(rows, "rmse")], [2.0, 2.0])
        self.assertEqual([point.error for point in error_curves.error_curve(rows, "mse")], [4.0, 4.0])

    def test_one_seed_has_no_band(self):
        point, = error_curves.error_curve([{"seed": "1", "pass": 1.0, "seconds": 1.0, "mse_corrected": 4.0}], "mse")
        self.assertIsNone(point.low)

    def test_what_the_reference_resolves_is_known_for_relative_errors(self):
        rows = [{"rel_mse_resolved": None}, {"rel_mse_resolved": 0.0009}]
        self.assertAlmostEqual(error_curves.resolved_error(rows, "rel_rmse"), 3)
        self.assertAlmostEqual(error_curves.resolved_error(rows, "rel_mse"), 0.0009)
        self.assertIsNone(error_curves.resolved_error(rows, "rmse"))

    def test_names_are_those_of_the_column_label(self):
        rows = [{"method": "path spp=4", "label": "paths"}, {"method": "vcm", "label": ""}]
        self.assertEqual(result_tables.labels_of(rows), {"path spp=4": "paths", "vcm": "vcm"})

    def test_labels_that_differ_in_spp_alone_are_one_method(self):
        def row(method, label, seeds=3, passes="4", external=""):
            return {"scene": "box", "component": "total", "method": method, "label": label, "seeds": seeds, "passes": passes,
                    "external": external}
        table = [row("path spp=4", "path spp=4"), row("path spp=16", "path spp=16", passes="15 to 16"),
                 row("path spp=64", "path spp=64", seeds=1, passes="64"),
                 row("m photons=10 spp=1", "map, 5 %, & more, photons=10, spp=1", passes="1"),
                 row("m photons=10 spp=4", "map, 5 %, & more, photons=10, spp=4"),
                 row("m photons=20 spp=4", "map, 5 %, & more, photons=20, spp=4"),
                 row("path filter=nlm spp=4", "typed, spp=4"), row("vcm k=1 spp=4", "vcm k=1 spp=4"), row("vcm k=2 spp=9", "vcm k=2 spp=9"),
                 row("other spp=1", "other spp=1", external="yes"), row("other spp=2", "other spp=2", external="yes")]
        curves = [{"scene": "box", "method": each["method"]} for each in table]
        found = method_names.one_label_a_method(result_tables.Results(curves, table, []))
        self.assertEqual(result_tables.labels_of(found.table), {
            "path spp=16": "path", "m photons=10 spp=4": "map, 5 %, & more, photons=10",
            "m photons=20 spp=4": "map, 5 %, & more, photons=20", "path filter=nlm spp=4": "typed, spp=4", "vcm k=1 spp=4": "vcm k=1 spp=4",
            "vcm k=2 spp=9": "vcm k=2 spp=9", "other spp=1": "other spp=1", "other spp=2": "other spp=2"})
        self.assertEqual([each["method"] for each in found.curves], [each["method"] for each in found.table])

    def test_images_are_those_at_the_reports_equal_time(self):
        try:
            from plotting import image_figure
        except ImportError:
            self.skipTest("matplotlib")
        rows = [{"method": method, "seed": seed, "pass": number, "seconds": seconds, "rel_mse_corrected": 1.69}
                for method, seed, number, seconds in (
                    ("fast", "1", 1, 0.3), ("fast", "1", 2, 1.2), ("fast", "2", 2, 0.8), ("late", "1", 1, 1.11),
                    ("late", "1", 2, 5), ("in time", "1", 1, 1.09), ("in time", "1", 2, 5), ("converged", "1", 1, 0.1))]
        with tempfile.TemporaryDirectory() as folder:
            for number, method in enumerate(result_tables.unique(row["method"] for row in rows)):
                cell = os.path.join(folder, "cells", str(number))
                os.makedirs(os.path.join(cell, "frames"))
                with open(os.path.join(cell, "cell.json"), "w", encoding="utf-8") as file:
                    json.dump({"scene": "box", "method": method, "seed": 1, "converged": method == "converged"}, file)
                for name in ("final.exr", "frames/1.exr"):
                    with open(os.path.join(cell, name), "w", encoding="utf-8"):
                        pass
            labels = {row["method"]: row["method"] for row in rows}
            seconds, images = image_figure.shown_images(folder, "box", rows, labels, os.path.basename)
        self.assertEqual(seconds, 1)
        self.assertEqual([(image.name, image.detail, image.pixels) for image in images[1:]], [
            ("fast", "130 %, 1.20 s", "final.exr"), ("late", "first image after 1.11 s", "1.exr"),
            ("in time", "130 %, 1.09 s", "1.exr"), ("converged", "130 %, 0.100 s", "final.exr")])

    def test_eleven_methods_have_colours_of_their_own(self):
        try:
            from plotting import figures
        except ImportError:
            self.skipTest("matplotlib")
        self.assertEqual(len({figures.line_style(i)["color"] for i in range(11)}), 11)

    def test_sweeps_are_of_rows_that_differ_in_one_number(self):
        def row(method, bias2=1e-3, state="measured"):
            name = method.replace("m photons", "photon map, photons").replace(" k=50", "")
            return {"method": method, "label": name, "bias2": bias2, "bias2_lo": bias2 / 2, "variance": 1e-3, "bias_state": state}
        rows = [row("m photons=1e5 k=50"), row("m photons=1e4 k=50"), row("m photons=1e6 k=50"), row("m photons=1e4 k=9"),
                row("path spp=1"), row("path spp=2"), row("path spp=3"),
                *(row(f"u x={x}", state="unbiased") for x in (1, 2, 3))]
        law = {"method": "m k=50", "parameter": "photons", "component": "total"}
        sweep, = bias_sweeps.sweeps_of(rows, [law])
        self.assertEqual((sweep.method, sweep.name, sweep.parameter, sweep.law), ("m k=50", "photon map", "photons", law))
        self.assertEqual([x for x, _ in sweep.points], [1e4, 1e5, 1e6])

    def test_the_component_of_largest_bias_is_a_resolved_one(self):
        rows = [{"component": c, "bias2": b, "bias2_lo": low} for c, b, low in
                (("total", 9, 8), ("direct", 7, -1), ("caustic", 3, 2), ("indirect", 4, 3))]
        self.assertEqual(bias_sweeps.component_of_largest_bias(rows), "indirect")
        self.assertEqual(bias_sweeps.component_of_largest_bias(rows[:2]), "total")

    def test_every_special_character_is_escaped(self):
        self.assertEqual(latex.escaped("a_b%&#${}"), r"a\_b\%\&\#\$\{\}")
        self.assertEqual(latex.escaped("\\^~<>|"), r"\textbackslash{}\textasciicircum{}\textasciitilde{}\textless{}"
                                                   r"\textgreater{}\textbar{}")


class SweepTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.parent = tempfile.TemporaryDirectory()
        curves = CURVES.replace(METHODS[0], "m photons=1000 k=5").replace(METHODS[1], "m photons=10000 k=5")
        cls.folder = result_folder(cls.parent.name, table=SWEEP, bias_laws=LAWS, curves=curves)
        cls.made = plot(cls.folder, "--format", "svg")

    @classmethod
    def tearDownClass(cls):
        cls.parent.cleanup()

    def test_bias_and_variance_stand_over_the_parameter(self):
        self.assertEqual(self.made.returncode, 0, self.made.stderr)
        figure = Svg(os.path.join(self.folder, "figures", "bias-photons-box.svg"))
        y = figure.axis(1, "y", True)
        for name, values in (("bias2", (2e-3, 2e-4, 2e-5)), ("variance", (1e-4,) * 3)):
            found = [y(position) for _, position in figure.marks(name)]
            self.assertEqual(len(found), 3)
            for value, wanted in zip(found, values):
                self.assertAlmostEqual(math.log(value), math.log(wanted), delta=0.01)
        fitted = [math.log(y(position)) for _, position in figure.corners("fit")]
        for found, wanted in zip(fitted, (2e-3, 2e-5), strict=True):
            self.assertAlmostEqual(found, math.log(wanted), delta=0.01)
        text = " ".join(figure.text())
        self.assertIn("caustic", text)  # its bias is resolved, and that of the total is not
        self.assertIn("p = 1.00 (0.90 to 1.10)", text)
        self.assertIn("theory, smooth light: 2.00", text)
        drawn = list(figure.groups)
        self.assertGreater(drawn.index("error"), max(drawn.index("variance"), drawn.index("bias2")), "the sum is on top")

    def test_names_are_short(self):
        text = " ".join(Svg(os.path.join(self.folder, "figures", "error-box.svg")).text())
        self.assertIn("m photons=1000", text)
        self.assertNotIn("k=5", text)


class TypedLabelsTest(unittest.TestCase):
    LABELS = (r"_a $x_1$ \alpha 5%", r"b \$ {c}^2 #&~")

    def setUp(self):
        self.parent = tempfile.TemporaryDirectory()
        self.addCleanup(self.parent.cleanup)

    def test_labels_are_shown_as_typed(self):
        lines = TABLE.splitlines(keepends=True)
        at = result_tables.TABLE.index("label")

        def labelled(line):
            fields = line.split(",")
            fields[at] = self.LABELS[METHODS.index(fields[1])]
            return ",".join(fields)
        folder = result_folder(self.parent.name, table=lines[0] + "".join(map(labelled, lines[1:])))
        self.assertEqual(plot(folder, "--format", "svg").returncode, 0)
        out = os.path.join(folder, "figures")
        text = Svg(os.path.join(out, "error-box.svg")).text()
        for label in self.LABELS:
            self.assertIn(label, text)
        table = content(out)["table-box.tex"].decode()
        self.assertIn(r"\texttt{\_a \$x\_1\$ \textbackslash{}alpha 5\%}", table)

    def test_the_heading_of_a_sweep_is_shown_as_typed(self):
        label = self.LABELS[0]
        table = re.sub(r",m photons=(\d+),", lambda match: f',"{label}, photons={match[1]}",', SWEEP)
        folder = result_folder(self.parent.name, table=table, bias_laws=LAWS)
        self.assertEqual(plot(folder, "--format", "svg").returncode, 0)
        text = " ".join(Svg(os.path.join(folder, "figures", "bias-photons-box.svg")).text())
        self.assertIn(f"{label}, caustic", text)

    def test_names_below_images_are_shown_as_typed(self):
        from matplotlib import rc_context
        import numpy
        from plotting import figures, image_figure
        with rc_context(figures.STYLE):
            sheet = image_figure.image_sheet([image_figure.Shown(label, "5 %", numpy.ones((2, 2, 3))) for label in self.LABELS], [], 6)
            path = os.path.join(self.parent.name, "images.svg")
            with open(path, "wb") as file:
                file.write(figures.saved(sheet, "svg"))
        for label in self.LABELS:
            self.assertIn(label, Svg(path).text())

    def test_the_caption_shows_a_file_that_was_made(self):
        from plotting import image_figure
        images = [image_figure.Shown(name, "5 %", None) for name in ("reference", self.LABELS[0])]
        for formats, command in ((["svg", "png", "pdf"], r"\includegraphics[width=\linewidth]{images-box.pdf}"),
                                 (["svg", "png"], r"\includegraphics[width=\linewidth]{images-box.png}"),
                                 (["svg"], r"\includesvg[width=\linewidth]{images-box.svg}")):
            text = image_figure.caption(images, "box", 1, formats, latex.escaped)
            self.assertIn(command, text)
            self.assertIn(r"\_a \$x\_1\$ \textbackslash{}alpha 5\%: 5 \%", text)


class ErrorTest(unittest.TestCase):
    def setUp(self):
        self.parent = tempfile.TemporaryDirectory()
        self.addCleanup(self.parent.cleanup)

    def refused(self, message, *arguments, **files):
        folder = result_folder(self.parent.name, **files)
        run = plot(folder, *arguments)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn(message.format(folder), run.stderr)
        self.assertNotIn("Traceback", run.stderr)
        self.assertFalse(os.path.exists(os.path.join(folder, "figures")))

    def test_wrong_files_are_named(self):
        self.refused("{}/curves.csv: there is no such file", curves=None)
        self.refused("{}/table.csv: the file is empty", table="")
        head = CURVES.split("\n", maxsplit=1)[0] + "\n"
        self.refused("{}/curves.csv: the table has no rows", curves=head)
        self.refused("{}/table.csv: there is no column 'bias2'", table=TABLE.replace("bias2,", "bias,", 1))
        self.refused("{}/curves.csv:2: 3 values for 8 columns", curves=head + "a,b,c\n")
        wrong = head + "box,path,1,1,x,1,1,1\n"
        self.refused("{}/curves.csv:2: column 'seconds': not a number: 'x'", curves=wrong)
        run = plot("/no/such/folder")
        self.assertEqual((run.returncode, run.stderr), (2, "/no/such/folder: there is no such folder\n"))

    def test_wrong_options_are_named(self):
        self.refused("{}/table.csv: there is no scene 'sphere'; it has: box", "--scene", "sphere")
        message = "{}/table.csv: there is no component of box 'volume'; it has: total, direct"
        self.refused(message, "--component", "volume")
        self.refused("there is no scene 'bxo'; did you mean 'box'? It has: box", "--scene", "bxo")
        self.refused("there is no format 'gif'", "--format", "pdf,gif")
        self.refused("'3.5' is not a length", "--width", "3.5")
        self.refused("there is no column 'varience'; did you mean 'variance'? There are: ", "--columns", "bias2,varience")
        self.refused("--columns is for the LaTeX table", "--columns", "bias2", "--images")
        self.refused("invalid choice: 'psnr'", "--metric", "psnr")

    def test_nothing_is_half_written(self):
        folder = result_folder(self.parent.name)
        os.makedirs(os.path.join(folder, "figures", "table-box.tex"))
        run = plot(folder, "--format", "svg")
        self.assertEqual(run.returncode, 2)
        self.assertIn(f"{folder}/figures/table-box.tex: Is a directory", run.stderr)
        self.assertEqual([name for name in os.listdir(os.path.join(folder, "figures")) if "unfinished" in name], [])

    def test_says_what_installs_matplotlib(self):
        # -S hides Debian's packages from Python; with this PATH nothing can be installed.
        tools = os.path.join(self.parent.name, "tools")
        os.mkdir(tools)
        for tool in ("bash", "dirname", "sed"):
            os.symlink(shutil.which(tool), os.path.join(tools, tool))
        run = plot(result_folder(self.parent.name), program=(sys.executable, "-S", "-B", PLOT), PATH=tools)
        self.assertEqual(run.returncode, 2)
        self.assertIn("./scripts/setup scripts/packages-plot.txt", run.stderr)
        self.assertNotIn("Traceback", run.stderr)


if __name__ == "__main__":
    if not importlib.util.find_spec("matplotlib"):
        print("skipped: matplotlib is not installed")
        sys.exit(77)
    unittest.main()
