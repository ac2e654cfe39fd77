"""The viewer of a report: the pixels that it shows, and the effects of its controls."""
import math
import os

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

import report_fixture as fixture
from report_browser import BOX, PATH, PHOTONS, ReportCase


class ViewerTest(ReportCase):
    def setUp(self):
        super().setUp()
        self.opened_with = self.label()
        self.choose("A", PATH)

    def test_opens_with_the_best_method(self):
        best = self.section.find_element(By.CSS_SELECTOR, ".tile.best").get_attribute("data-method")
        self.assertIn(f"A: {best}", self.opened_with)

    def test_values_are_those_of_the_files(self):
        method = self.pixels(PATH)
        reference = self.pixels("reference")
        for x, y in ((3, 4), (16, 2), (20, 27), (31, 31)):
            self.go_to(x, y)
            self.assert_pixel(self.values("A"), method[x, y])
            self.assert_pixel(self.values("B"), reference[x, y])

    def test_components_are_those_of_the_files(self):
        seen = []
        for component in ("direct", "indirect"):
            self.choose("Component", component)
            self.go_to(10, 20)
            expected = self.pixels(PATH, component)[10, 20]
            self.assert_pixel(self.values("A"), expected)
            seen.append(self.values("A"))
        self.assertNotEqual(seen[0], seen[1])

    def test_time_chooses_the_image_that_fits_into_it(self):
        self.go_to(9, 22)
        final = self.values("A")
        slider = self.control("Time")
        self.assertIn("final images", slider.get_attribute("aria-valuetext"))
        self.choose("A", PATH)
        times = self.script("return arguments[0].panel.sources.times", self.section)
        curve = [(float(row["seconds"]), int(row["pass"])) for row in fixture.rows(self.results, "curves.csv")
                 if (row["scene"], row["method"], row["seed"]) == (BOX, PATH, "1")]
        kept = [(t, p) for t, p in curve if p & (p - 1) == 0]
        folder = fixture.cell_folder(self.results, BOX, PATH, 1)
        self.keys(slider, Keys.HOME)
        seen = set()
        for step, time in enumerate(times):
            fitting = [p for t, p in kept if t <= time * (1 + 1e-6)]
            label = self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text
            if not fitting:
                self.assertIn("no image yet", label)
            else:
                self.assertIn(f"{fitting[-1]} pass", label)
                name = f"frames/{fitting[-1]}.exr" if fitting[-1] < 64 else "final.exr"
                self.assert_pixel(self.values("A"), fixture.pixels(os.path.join(folder, name))[9, 22])
                seen.add(fitting[-1])
            if step + 1 < len(times):
                self.keys(slider, Keys.ARROW_RIGHT)
        self.assertEqual(seen, {1, 2, 4, 8, 16, 32, 64})
        self.assertEqual(self.values("A"), final)

    def test_maps_are_computed_from_the_images(self):
        x, y = 11, 23
        self.go_to(x, y)
        image = self.pixels(PATH)[x, y]
        whole = self.pixels("reference")
        r = whole[x, y]
        luminances = [0.212671 * v[0] + 0.715160 * v[1] + 0.072169 * v[2] for v in whole.values()]
        epsilon = (0.1 * sum(luminances) / len(luminances)) ** 2
        scale = [math.sqrt(v * v + epsilon) for v in r]
        self.press("error")
        legend = self.section.find_element(By.CSS_SELECTOR, ".map-legend")
        self.assertIn("25.0 % and more", legend.text)
        error = sum(abs(a - b) / s for a, b, s in zip(image, r, scale)) / 3
        self.assertAlmostEqual(self.values("A")[0], 100 * error, delta=0.2 + 1e-2 * error)
        self.assertEqual(self.values("B"), [0])
        plain = self.canvas(x, y)
        self.keys(self.control("Amplification"), *[Keys.ARROW_RIGHT] * 8)
        self.assertIn("6.25 % and more", legend.text)
        self.assertNotEqual(self.canvas(x, y), plain)
        self.shot("map-error")
        self.press("bias")
        seeds = [fixture.pixels(os.path.join(fixture.cell_folder(self.results, BOX, PATH, s), "final.exr"))[x, y]
                 for s in (1, 2, 3)]
        bias = sum((sum(seed[k] for seed in seeds) / 3 - r[k]) / scale[k] for k in range(3)) / 3
        self.assertAlmostEqual(self.values("A")[0], 100 * bias, delta=0.02 + 5e-3 * abs(100 * bias))
        self.assertIn("measured against", self.label_of_b())
        self.press("FLIP")
        self.assertFalse(self.control("Amplification").is_enabled())
        self.assertTrue(0 <= self.values("A")[0] <= 1)
        self.shot("map-flip")

    def label_of_b(self):
        self.keys(self.stage, Keys.SPACE)
        text = self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text
        self.keys(self.stage, Keys.SPACE)
        return text

    def test_maps_of_flip_have_the_mean_of_the_table(self):
        self.press("FLIP")
        mean = self.script(
            "const v = arguments[0].panel.stage.sides[0].map.values;"
            "return v.reduce((a, b) => a + b) / v.length", self.section)
        folder = fixture.cell_folder(self.results, BOX, PATH, 1)
        self.assertAlmostEqual(mean, fixture.record(folder, "flip.json")["flip"], delta=1 / 255)

    def test_errors_of_pixels_in_other_metrics(self):
        x, y = 11, 23
        self.go_to(x, y)
        pairs = list(zip(self.values("A"), self.values("B")))
        epsilon = self.script("return arguments[0].panel.sources.pictures.epsilon", self.section)
        self.press("error")
        legend = self.section.find_element(By.CSS_SELECTOR, ".map-legend")
        for name, expected, words in (("relative, squared", sum((a - b) ** 2 / (b * b + epsilon) for a, b in pairs) / 3, "0.0625 and more"),
                                      ("absolute", sum(abs(a - b) for a, b in pairs) / 3, "|x − r|")):
            self.choose("Error", name)
            self.assertAlmostEqual(self.values("A")[0] / expected, 1, delta=0.02)
            self.assertIn(words, legend.text)
        self.press("image")
        with self.assertRaisesRegex(AssertionError, "no control"):
            self.control("Error")

    def test_the_address_holds_the_state(self):
        def state():
            return self.script("const {state, stage} = arguments[0].panel; return [state, stage.x, stage.y, stage.zoom]", self.section)
        self.press("slide")
        self.choose("A", PHOTONS)
        self.choose("Component", "indirect")
        self.choose("Tone", "filmic")
        self.keys(self.control("Exposure"), *[Keys.ARROW_LEFT] * 3)
        self.press("+")
        before = state()
        self.wait(lambda: "#viewer-0?" in self.driver.current_url and "zoom=" in self.driver.current_url, "the address")
        address = self.driver.current_url
        self.driver.get("about:blank")
        self.driver.get(address)
        self.section = self.driver.find_element(By.ID, "scene-0")
        self.stage = self.section.find_element(By.CSS_SELECTOR, ".stage")
        self.settle()
        after = state()
        self.assertEqual(after[0], before[0])
        for found, expected in zip(after[1:], before[1:]):
            self.assertAlmostEqual(found, expected, places=6)
        self.assertEqual(self.control("Component").get_attribute("value"), str(after[0]["layer"]))
        self.assertIn(PHOTONS, self.label())
        for wrong in ("#viewer-9?a=1", "#viewer-0?a=no&nothing=3"):
            self.script("location.hash = arguments[0]", wrong)
            self.settle()
        self.assertEqual(state()[0], before[0])

    def test_pyramid_shows_the_techniques(self):
        rows = self.section.find_elements(By.CSS_SELECTOR, ".pyramid-row")
        names = [[cell.text for cell in row.find_elements(By.CSS_SELECTOR, ".technique")] for row in rows]
        self.assertEqual([len(row) for row in names], [1, 3, 4, 5, 6])
        self.assertEqual(names[1], ["k 2, s 0, t 3", "k 2, s 1, t 2", "k 2, s 2, t 1"])
        for kind, ending in (("weighted", ""), ("each technique alone", "_alone")):
            self.press(kind)
            layer = "technique_k2_s1_t2" + ending
            cell = self.section.find_elements(By.CSS_SELECTOR, ".pyramid-row")[1] \
                .find_elements(By.CSS_SELECTOR, ".technique")[1]
            expected = self.pixels(fixture.METHODS[3], layer)[10, 20]
            exposure = self.script("return 2 ** arguments[0].panel.state.stops", self.section)
            shown = [round(fixture.srgb(value * exposure)) for value in expected]
            self.wait(lambda: all(abs(a - b) <= 1 for a, b in zip(self.drawn(cell, 10, 20), shown)), "the picture")
            self.scroll_to(cell)
            self.shot(f"pyramid{ending}")
            cell.click()
            self.settle()
            self.go_to(10, 20)
            self.assert_pixel(self.values("A"), expected)
            self.assertIn("bidirectional", self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text)

    def drawn(self, cell, x, y):
        """The bytes of a pixel of a technique's picture."""
        return self.script(
            "return [...arguments[0].querySelector('canvas').getContext('2d').getImageData(arguments[1], arguments[2], 1, 1)"
            ".data].slice(0, 3)", cell, x, y)
