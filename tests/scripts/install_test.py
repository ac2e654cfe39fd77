"""Tests of `cmake --install`: the installed program works after it was moved, from any folder, without the sources.
Usage: install_test.py CMAKE BUILD_FOLDER"""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD = sys.argv[1:3]


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        first, cls.prefix, cls.work = (os.path.join(folder.name, name) for name in ("first", "moved here", "work"))
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", first], stdout=subprocess.DEVNULL, check=True)
        os.rename(first, cls.prefix)
        os.mkdir(cls.work)
        # Names that the sources do not have show that the installed files are read.
        shutil.copy(cls.installed("share/gibench/scenes/textured-room.xml"),
                    cls.installed("share/gibench/scenes/moved-room.xml"))
        with open(cls.installed("share/gibench/experiments/moved.toml"), "w", encoding="utf-8") as file:
            file.write('title = "Moved"\nscenes = ["../scenes/moved-room.xml"]\nresolution = [8, 8]\n'
                       'budget = { passes = 1 }\n[reference]\ntarget = "60%"\n[[method]]\nname = "path"\n')

    @classmethod
    def installed(cls, name):
        return os.path.join(cls.prefix, name)

    def gibench(self, *arguments, code=0):
        done = subprocess.run([self.installed("bin/gibench"), *arguments], cwd=self.work, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout + done.stderr

    def files(self):
        return sorted(os.path.join(folder, name) for folder, _, names in os.walk(self.prefix) for name in names)

    def test_scenes_and_experiments_are_found_by_name(self):
        self.assertIn("\nmoved-room\n", self.gibench("list", "scenes"))
        self.assertIn("\ncornell-glass                ", self.gibench("list", "scenes"))
        self.assertIn("\nmoved                        Moved\n", self.gibench("list", "experiments"))
        self.assertIn("called for: direct_light\n", self.gibench("plan", "moved-room", "--method", "path"))

    def test_renders_with_the_installed_image_library(self):
        render = ["render", "moved-room", "--method", "path spp=1", "--resolution", "8x8", "-o", "a.exr"]
        self.gibench(*render)
        library = self.installed("lib/gibench/libgib_images.so")
        os.rename(library, library + ".good")
        with open(library, "w", encoding="utf-8"):
            pass
        self.assertIn(library, self.gibench(*render, code=1))
        os.replace(library + ".good", library)

    def test_results_go_to_the_working_folder(self):
        before = self.files()
        self.gibench("run", "moved")
        self.assertTrue(os.path.exists(os.path.join(self.work, "results/moved/report.html")))
        self.assertTrue(os.listdir(os.path.join(self.work, "results/references")))
        self.assertEqual(self.files(), before)

    def test_bash_finds_the_completion(self):
        with open(self.installed("share/bash-completion/completions/gibench"), encoding="utf-8") as file:
            self.assertIn("complete -o bashdefault -o default -F _gibench gibench", file.read())

    def test_every_command_has_a_manual_page(self):
        for page, text in (("gibench", "compare\\-runs"), ("gibench-run", "\\-\\-seeds"), ("gibench-compare-runs", "worse")):
            with open(self.installed(f"share/man/man1/{page}.1"), encoding="utf-8") as file:
                self.assertIn(text, file.read())

    def test_a_build_for_this_processor_makes_no_package(self):
        with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as file:
            if "GIB_NATIVE:BOOL=ON" not in file.read():
                self.skipTest("this build may be packaged")
        done = subprocess.run([os.path.join(os.path.dirname(CMAKE), "cpack")], cwd=BUILD, capture_output=True, text=True,
                              check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("cmake --workflow --preset package", " ".join(done.stderr.split()))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
