"""The charts, tables and layout of a report."""
import math
import os

from selenium.webdriver.common.by import By

import report_fixture as fixture
from report_browser import BOX, LAPTOP, PATH, PHOTONS, ReportCase


class ChartTest(ReportCase):
    def chart(self, place):
        return self.script(
            "const c = Chart.getChart(arguments[0].querySelector(arguments[1] + ' canvas'));"
            "return c ? c.data.datasets.map((d) => ({label: d.label, hover: d.hover, data: d.data})) : null",
            self.section, place)

    def points(self, method, place=".curve-chart"):
        found = [set for set in self.chart(place) if set["label"] == method and set["hover"] is not False]
        return [(p["x"], p["y"]) for p in found[0]["data"]] if found else None

    def test_curves_are_those_of_the_table(self):
        for metric, column, factor in (("relative RMSE", "rel_mse_corrected", 100), ("RMSE", "mse_corrected", 1)):
            self.press(metric, ".scene-controls")
            expected = []
            for at in zip(*(fixture.checkpoints(self.results, BOX, PATH, seed) for seed in (1, 2, 3))):
                square = sum(checkpoint["errors"]["total"][column] for checkpoint in at) / 3
                if square > 0:
                    expected.append((sum(checkpoint["seconds"] for checkpoint in at) / 3, factor * math.sqrt(square)))
            found = self.points(PATH)
            self.assertEqual(len(found), len(expected))
            for one, other in zip(found, expected):
                self.assertAlmostEqual(one[0] / other[0], 1, places=6)
                self.assertAlmostEqual(one[1] / other[1], 1, places=6)

    def test_component_changes_charts_and_tables(self):
        places = (".curve-chart", ".noise-chart")
        before = [self.points(PATH, place) for place in places]
        self.choose("Component", "indirect", ".scene-controls")
        for place, old in zip(places, before):
            self.assertTrue(self.points(PATH, place))
            self.assertNotEqual(self.points(PATH, place), old)
        self.script("for (const d of document.querySelectorAll('.folded')) d.open = true")
        shown = [row.get_attribute("data-component") for row in
                 self.section.find_elements(By.CSS_SELECTOR, "tr[data-component]") if row.is_displayed()]
        self.assertEqual(set(shown), {"indirect"})

    def test_methods_can_be_left_out_of_the_charts(self):
        self.assertIsNotNone(self.points(PHOTONS))
        self.press(PHOTONS, ".scene-controls")
        self.assertIsNone(self.points(PHOTONS))
        self.assertIsNone(self.points(PHOTONS, ".noise-chart"))
        self.assertIsNotNone(self.points(PATH))
        self.press(PHOTONS, ".scene-controls")
        self.assertIsNotNone(self.points(PHOTONS))


class PageTest(ReportCase):
    def test_paper_has_all_pictures_and_tables_whole(self):
        self.wait(lambda: self.script("return [...document.querySelectorAll('section.scene')].every((s) => s.strip.drawn)"),
                  "the strips of all scenes are drawn, in sight or not")
        # A4 landscape without its margins at 96 dots per inch.
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": 1047, "height": 718, "deviceScaleFactor": 1, "mobile": False})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        try:
            self.script("dispatchEvent(new Event('beforeprint'))")
            self.shot("print")
            self.assertEqual(self.script("return document.querySelectorAll('details:not([open])').length"), 0)
            self.assert_fits("paper")
            cut = self.script("""
                return [...document.querySelectorAll(".scroll, .chart-box, td, th, figcaption, li")]
                  .filter((e) => e.checkVisibility() && e.scrollWidth > e.clientWidth + 1)
                  .map((e) => e.className + " " + e.textContent.slice(0, 60))""")
            self.assertEqual(cut, [])
            blank = self.script("""
                return [...document.querySelectorAll(".tile canvas, .chart-box canvas")].filter((e) => e.checkVisibility())
                  .filter((e) => !e.getContext("2d").getImageData(0, 0, e.width, e.height).data.some((v) => v > 0))
                  .map((e) => e.getAttribute("aria-label"))""")
            self.assertEqual(blank, [])
            shown = self.script("""
                const shown = (selector) => [...document.querySelectorAll(selector)].some((e) => e.checkVisibility());
                return [".methods .swatch", ".scene-controls select", ".viewer"].map(shown)""")
            self.assertEqual(shown, [True, False, False], "of the controls, the key to the colours alone is printed")
            self.script("dispatchEvent(new Event('afterprint'))")
            self.assertGreater(self.script("return document.querySelectorAll('details:not([open])').length"), 0)
        finally:
            self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})

    def test_without_scripts_the_numbers_can_be_read(self):
        text = self.text_without_scripts(os.path.join(self.results, "report.html"))
        for words in ("A test of the report: <b>&amp; co", "Price list", "cheapest", "indirect", PHOTONS, "noise",
                      "Where the time goes"):
            self.assertIn(words, text)

    def test_the_other_scene_has_its_own_images(self):
        self.open(LAPTOP, scene=1)
        self.choose("A", PATH)
        self.go_to(15, 18)
        expected = fixture.pixels(os.path.join(self.images, "cornell-glass-path_spp=64.exr"))[15, 18]
        self.assert_pixel(self.values("A"), expected)
        self.choose("Component", "caustic")
        self.choose("A", fixture.METHODS[2])
        self.assertIn("does not simulate", self.label())
