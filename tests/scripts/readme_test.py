"""Tests of every *.md file: links, named files, commands, experiment files, and of the labels, columns, keys and options
that these and the comments of *.toml files name: readme_test.py GIBENCH [SECONDS]

GIBENCH is the program. SECONDS is the longest time that one command may take; default: 120. The commands of each
document run from top to bottom in a scratch folder that looks like the top of the repository.
"""
import os
import re
import sys
import tempfile
import unittest

from readme_checks import Checker, Scratch, exit_codes
from readme_names import Names

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))


def checker_of(root):
    return Checker(root, os.path.realpath(PROGRAM), SECONDS)


class DocumentTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.checker = checker_of(ROOT)
        cls.names = Names(cls.checker)

    def none(self, problems):
        problems = list(problems)
        if problems:
            self.fail(f"{len(problems)} problems:\n" + "\n".join(problems))

    def test_links_lead_somewhere(self):
        self.assertIn("README.md", [document.name for document in self.checker.documents])
        self.none(self.checker.broken_links())

    def test_named_files_exist(self):
        self.none(self.checker.missing_paths())

    def test_named_functions_exist(self):
        self.none(self.checker.missing_functions())

    def test_inline_commands_exist(self):
        self.none(self.checker.wrong_inline_commands())

    def test_program_takes_every_label(self):
        self.none(self.names.refused_labels())

    def test_named_columns_exist(self):
        self.none(self.names.unknown_columns())

    def test_named_keys_exist(self):
        self.none(self.names.unknown_keys())

    def test_named_options_exist(self):
        self.none(self.names.unknown_options())

    def test_words_are_those_of_program_or_source(self):
        self.none(self.names.unknown_words())

    def test_commands_in_comments_exist(self):
        self.none(self.names.wrong_commands())

    def test_commands_and_experiments_work(self):
        for document in self.checker.documents:
            with self.subTest(document.name):
                self.none(self.checker.failing_blocks(document))

    def test_every_column_is_explained(self):
        self.none(self.checker.unexplained_columns("experiments/REFERENCE.md"))


class CheckerTest(unittest.TestCase):
    """Each check finds what it is for, in a small repository with wrong documents."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for name in ("scenes", "scripts", "CMakePresets.json", ".gitignore"):
            os.symlink(os.path.join(ROOT, name), os.path.join(self.folder.name, name))
        for name in ("methods/path", "experiments"):
            os.makedirs(os.path.join(self.folder.name, name))
        self.write("methods/path/path.cpp", "int estimate();\n")
        self.write("CMakeLists.txt", "set(LABELS quick)  # slow\noption(GIB_NATIVE)\n")

    def write(self, name, text):
        with open(os.path.join(self.folder.name, name), "w", encoding="utf-8") as file:
            file.write(text)

    def checker(self, text, name="README.md"):
        self.write(name, text)
        return checker_of(self.folder.name)

    def expect(self, problems, *expected):
        problems = list(problems)
        self.assertEqual(len(problems), len(expected), problems)
        for problem, text in zip(problems, expected):
            self.assertIn(text, problem)

    def test_links(self):
        checker = self.checker(
            "# A `b`: c, d\n# Two\n# Two\n[x](#a-b-c-d) [x](#two-1) [x](methods/path/path.cpp) [x](https://a.b/c)\n"
            "`[x](in-code)` ![x](scenes/cornell-glass.png)\n[x](none.md)\n[x](#two-2)\n\n"
            "![x](none.png)\n[a]: methods/none\n<img src=\"none.svg\">\n\n    [x](in-block)\n")
        self.expect(checker.broken_links(), "README.md:6: none.md",
                    "README.md:7: #two-2: README.md has no such heading", "README.md:9: none.png",
                    "README.md:10: methods/none", "README.md:11: none.svg")

    def test_paths(self):
        good = "`methods/path/` `methods/path/path` `methods/*/path.{cpp}` `methods/NAME.cpp` `methods/<name>/x.h`\n" \
               "`results/a/b.csv` `and/or` `path.cpp` `scenes/`\n" \
               "`scenes/meshes/generated/x.ply`\n"
        self.expect(self.checker(good).missing_paths())
        checker = self.checker("`methods/none.cpp`\n`methods/path/*.xyz` `common/none`\n`methods/path/path.{cpp,h}`\n"
                               "`none.h`\n")
        self.expect(checker.missing_paths(), "README.md:1: methods/none.cpp", "README.md:2: methods/path/*.xyz",
                    "README.md:2: common/none", "README.md:3: methods/path/path.{cpp,h}", "README.md:4: none.h")

    def test_functions(self):
        checker = self.checker("`methods/path/path.cpp`: `estimate()`, `A::estimate`, the line `x`\n"
                               "`methods/path/path.cpp`: `estimate`, `B::none`\n")
        self.expect(checker.missing_functions(), "README.md:2: methods/path/path.cpp: the file has no none")

    def test_paths_beside_the_document(self):
        checker = self.checker("`path/path.cpp`\n`path/none.cpp`\n", "methods/README.md")
        self.expect(checker.missing_paths(), "methods/README.md:2: path/none.cpp")

    def test_inline_commands(self):
        self.expect(self.checker("`gibench list methods --parameters` `scripts/sanitize tsan -R Photon` `gibench run`\n"
                                 "`./scripts/run FILE.toml --seeds 5` `scripts/fuzz [TARGET ...] [--seconds N]`\n"
                                 "`gibench plan scenes/NAME.xml` `ctest --preset release -L quick`\n"
                                 "`cmake --build --preset release` `cmake --preset debug -DGIB_NATIVE=OFF`"
                                 ).wrong_inline_commands())
        checker = self.checker("`gibench run --sneeds 5` `gibench dance now`\n"
                               "`scripts/none now` `scripts/plot x --colour`\n"
                               "`scripts/fuzz --minutes 3` `./scripts/run --sneeds 5`\n"
                               "`gibench plan scenes/none.xml`\n"
                               "`ctest --preset none -L quick` `ctest --preset fuzz -L slow`\n"
                               "`cmake --preset none -DGIB_NONE=ON` `cmake --build --preset base`")
        self.expect(checker.wrong_inline_commands(), "1: gibench run --sneeds 5: it has no option --sneeds",
                    "no such command", "2: scripts/none now: there is no such script", "no option --colour",
                    "3: scripts/fuzz --minutes 3: it has no option --minutes", "no option --sneeds",
                    "4: gibench plan scenes/none.xml: there is no file scenes/none.xml", "5: ctest", "no preset 'fuzz'",
                    "no CMakeLists.txt has the label 'slow'", "6: cmake", "option GIB_NONE", "buildPresets")

    def names(self, text, comments=""):
        self.write("experiments/mine.toml", comments + "\n[[method]]\nname = \"vcm\"\n")
        return Names(self.checker(text, "experiments/README.md"))

    def test_labels(self):
        good = "`photon_mapper photons=1e4 gather=8 cache=on` `cache=on` `source=paths` `gather=N` `-x=1` `x <= 3`\n" \
               "`--set rho=0.9` `--vary \"radius=0.1..0.2\"` `srun -e x=2` `vcm` with `radius=0.01`\n\n" \
               "| `path spp=4` | the same, spp=8 | vcm radius=0.1, k = 5 | x=\"y\" |\n"
        self.expect(self.names(good, "# vcm radius=0.01: `radius=0.02`, with radius=0.03.\n").refused_labels())
        names = self.names("`photon_mapper cache=on` `adapt=off` `cache=on gather=0` `kernel=cone,flat` `glass spp=4`\n"
                           "`path` with `gather=8` `--method none` `photon_mapper gather=N adapt=N`\n\n"
                           "| `source=metres` | path spp=8 k=5 | the same, sampler=none |\n",
                           "# x\n# cache=on\n# vcm\n# spp=none\n\n# path with guide=on\n")
        self.expect(names.refused_labels(), "README.md:1: photon_mapper cache=on: parameter 'cache' has no effect",
                    "adapt=off: no method", "cache=on gather=0: parameter 'cache'", "kernel=cone,flat: parameter",
                    "glass spp=4: unknown method", "2: gather=8: path has no", "2: none: there is no such method",
                    "gather=N adapt=N: photon_mapper has no parameter adapt", "4: source=metres: parameter",
                    "4: spp=8 k=5: path has no parameter k", "4: sampler=none: parameter 'sampler'",
                    "mine.toml:2: cache=on: no method", "mine.toml:4: spp=none: parameter 'spp'",
                    "mine.toml:6: guide=on: path has no")

    def test_named_columns(self):
        good = "The columns `scene`, `method` and `seconds_to_0.5pct_lo` of `table.csv`, column `stage`,\n" \
               "`x` of `a.csv`, table.csv: `rmse`; the stages `links` and `solution` in stages.csv `--columns flip,rmse`\n"
        self.expect(self.names(good, "# (table.csv: `component`)").unknown_columns())
        names = self.names("columns `scene` and `layer`, the `layer` column, column `frequency` of `table.csv`\n"
                           "`seconds` and `seconds_to_3pct` in table.csv, `--columns flip,none`\n",
                           "# x\n# (table.csv: `bias2`,\n# `layer`)\n")
        self.expect(sorted(names.unknown_columns()), "README.md:1: frequency: table.csv", "README.md:1: layer: no CSV",
                    "README.md:2: none: --columns", "README.md:2: seconds_to_3pct: table.csv",
                    "mine.toml:2: layer: table.csv")

    def test_named_keys(self):
        self.expect(self.names("Keys `seeds` and `minutes`, key `x` of `a.json`, `label` of a `[[method]]`, `[tune]` `[a, b]`\n"
                               "`seeds = 3` `budget = { passes = 4 }` `gather = 8` `is_good = true;` `a = b`\n").unknown_keys())
        self.expect(self.names("keys `seeds` and `steps`, `none` of a `[[method]]`, `[limits]`\n`steps = 3`\n"
                               "`budget = { minutes = 4 }` `fresh = true`\n").unknown_keys(),
                    "1: steps", "1: none", "1: limits", "2: steps", "3: minutes", "3: fresh")

    def test_named_options(self):
        self.expect(self.names("`--fresh` `--sbatch \"--none=1\"` `srun --none` `--crop 1,2` `run --seeds N`",
                               "# with --only or `--vary \"k=1..2\"`\n").unknown_options())
        self.expect(self.names("`--none`\n`--seeds N --colour` `run --sneeds`", "# x\n# with --none\n").unknown_options(),
                    "1: --none", "2: --colour", "2: --sneeds", "mine.toml:2: --none")

    def test_named_words(self):
        self.expect(self.names("`rmse` `photons` `gibench` `scenes` `compare` `f()` `E` `wX_y` `_lo` `quality`\n"
                               "```toml\nquality = 3\n```\n", "# `vcm` `name`\n").unknown_words())
        names = self.names("`layer`\n`rel_mse_gone`", "# x\n# `layer`\n")
        names.documents.append(self.checker("`estimate` `gone`\n`photon_gone` `p_l`\n", "methods/README.md").documents[-1])
        self.expect(names.unknown_words(), "1: layer", "2: rel_mse_gone", "mine.toml:2: layer",
                    "methods/README.md:2: photon_gone")

    def test_commands_in_comments(self):
        self.expect(self.names("`gibench run first-look --fresh` `gibench plan cornell-box` `gibench run my.toml`\n",
                               "# `gibench run first-look`; needs scripts/meshes\n").wrong_commands())
        self.expect(self.names("`gibench plan none` `gibench run cornell-box`", "# `gibench dance now`\n# ./scripts/none\n"
                               ).wrong_commands(), "mine.toml:1: gibench dance now", "mine.toml:2: scripts/none",
                    "README.md:1: gibench plan none", "README.md:1: gibench run cornell-box")

    def blocks(self, text):
        checker = self.checker(text)
        return checker.failing_blocks(checker.documents[0])

    def test_commands_of_blocks(self):
        self.expect(self.blocks(
            "A\n\n    gibench list effects   # exit code 0: good, 1: bad\n    ls none\n\n```text\ngibench none\n```\n"
            "```sh\ngibench list \\\n    methods\nGIB_X=1 build/release/experiments/gibench plan scenes/none.xml  "
            "# exit code 2\n```\n1. a\n\n       gibench list scenes\n"))
        self.expect(self.blocks("A\n\n    gibench list effects\n    gibench list nothing\n\n```sh\ngibench list effects"
                                "  # exit code 1\n./scripts/run none.toml\n```\n- b\n\n    gibench list none\n"),
                    "README.md:4: gibench list nothing: exit code 2 instead of 0",
                    "README.md:7: gibench list effects  # exit code 1: exit code 0 instead of 1",
                    "README.md:8: ./scripts/run none.toml: there is no file none.toml",
                    "README.md:12: gibench list none: exit code 2 instead of 0")

    def test_exit_codes(self):
        for comment, codes in (("", {0}), ("# exit code 1", {1}), ("# makes it; exit code 2: wrong", {2}),
                               ("# exit code 0: yes, 1: no, 2: wrong input", {0, 1})):
            self.assertEqual(exit_codes("gibench x '# exit code 7' " + comment if comment else "gibench x"), codes)

    def test_commands_that_hang(self):
        checker = self.checker("")
        checker.seconds = 0.5
        with tempfile.TemporaryDirectory() as folder:
            code, output = Scratch(checker, folder, checker.documents[0]).run("echo begun; sleep 60 & sleep 60")
        self.assertEqual((code, output), (None, "begun\n"))

    def test_results_are_there(self):
        self.expect(self.blocks("A\n\n    gibench report results/first-look\n    gibench run --repeat results/b\n"
                                "    ./scripts/plot results/first-look --scene furnace --format svg --out ~/figures\n"))
        self.expect(self.blocks("A\n\n    gibench report other/first-look\n"), "other/first-look")

    def test_columns(self):
        checker = self.checker("`scene`, `method` `seed` `pass`, `rmse` `_lo` `seconds_to_Npct` seconds\n")
        text = "\n".join(checker.unexplained_columns("README.md"))
        for missing in ("`seconds` of table.csv", "`rmse_hi` of", "`seconds_to_5pct_hi` of", "`photons` of curves.csv",
                        "`frequency` of spectra.csv", "`stage` of stages.csv"):
            self.assertIn("README.md: the column " + missing, text)
        for known in ("`scene`", "`rmse`", "`rmse_lo`", "`seconds_to_0.5pct`", "`seconds_to_5pct_lo`"):
            self.assertNotIn(known, text)

    def test_experiments_and_scenes(self):
        good = "Save this as `mine.toml`:\n```toml\nscenes = [\"scenes/cornell-box.xml\"]\n[[method]]\n" \
               "name = \"path\"\n```\n\n    ./scripts/run mine.toml\n\nA part:\n\n" \
               "```toml\n[budget]\npasses = 3\n```\n"
        self.expect(self.blocks(good))
        self.expect(self.blocks(good.replace("passes", "steps")), "README.md:13: block-13.toml: is refused")
        self.expect(self.blocks(good.replace("\"path\"", "\"none\"")), "README.md:3: mine.toml: is refused")
        self.expect(self.blocks(good.replace("`mine.toml`", "that")))  # then the command names the file
        self.expect(self.blocks(good.replace("run mine", "run none")), "there is no file none.toml")
        self.expect(self.blocks("`a.xml`\n```xml\n<scene version=\"3.0.0\"></scene>\n```\n```xml\n<bsdf/>\n```\n"),
                    "README.md:3: a.xml: is refused")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    SECONDS = float(sys.argv.pop(1)) if len(sys.argv) > 1 and re.fullmatch(r"[\d.]+", sys.argv[1]) else 120.0
    unittest.main()
