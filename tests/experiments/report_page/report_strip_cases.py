"""The strip of a report: an image of each method at equal time, before anything else."""
from selenium.webdriver.common.by import By

import report_fixture as fixture
from report_browser import BOX, LAPTOP, PATH, ReportCase


class StripTest(ReportCase):
    def setUp(self):
        super().setUp()
        self.look(LAPTOP)

    def look(self, size, scheme="light"):
        """Opens the page at its top and waits until the strip is drawn."""
        self.open(size, scheme)
        self.script("scrollTo(0, 0)")
        self.wait(lambda: self.script("return arguments[0].strip?.drawn === true", self.section),
                  "the strip is drawn")

    def tiles(self):
        return self.section.find_elements(By.CSS_SELECTOR, ".tile")

    def tile(self, method):
        return self.section.find_element(By.CSS_SELECTOR, f'.tile[data-method="{method}"]')

    def pixel(self, canvas, x, y):
        return self.script("""
            const one = new OffscreenCanvas(1, 1).getContext("2d", {willReadFrequently: true});
            one.drawImage(arguments[0], -arguments[1], -arguments[2]);
            return [...one.getImageData(0, 0, 1, 1).data]""", canvas, x, y)[:3]

    def test_each_tile_has_its_line(self):
        table = {row["method"]: row for row in fixture.rows(self.results, "table.csv")
                 if row["scene"] == BOX and row["component"] == "total"}
        texts = {tile.get_attribute("data-method"): tile.text for tile in self.tiles()[1:]}
        for method, text in texts.items():
            self.assertRegex(text, r"\d %, FLIP 0\.\d\d\d|no image yet; first after [\d.]+ s")
            self.assertRegex(text, "noise|bias")
            for effect in filter(None, table[method]["effects_missing"].split(";")):
                self.assertIn(effect.replace("_", " "), text)
        self.assertIn("noise", texts[PATH])
        self.assertNotIn("path spp=16", texts, "it is the same method, which stopped earlier")

    def test_the_best_is_framed_and_has_kept_the_time(self):
        best = self.section.find_elements(By.CSS_SELECTOR, ".tile.best")
        self.assertEqual(len(best), 1)
        self.assertEqual(best[0], self.tiles()[1], "it stands beside the reference")
        self.assertIn("best", best[0].text)
        for tile in self.section.find_elements(By.CSS_SELECTOR, ".tile.best, .tile.tie"):
            self.assertNotIn("late", tile.get_attribute("class"))
        for tile in self.section.find_elements(By.CSS_SELECTOR, ".tile.late"):
            self.assertIn("no image yet", tile.text)

    def test_images_and_error_maps_are_those_of_the_viewer(self):
        for method in fixture.METHODS[:3]:
            tile = self.tile(method)
            for name in ("image", "error"):
                canvas = tile.find_element(By.CSS_SELECTOR, f"canvas.{name}")
                shown = [self.pixel(canvas, x, y) for x, y in ((10, 20), (16, 4), (25, 28))]
                self.script("arguments[0].scrollIntoView()", canvas)
                canvas.click()
                self.settle()
                label = self.label()
                self.assertIn("A: " + method, label)
                passes = self.script(
                    "return arguments[0].strip.tiles.find((t) => t.place === arguments[1]).at.passes", self.section, tile)
                self.assertIn(f"{passes} pass", label)
                self.script("arguments[0].panel.stage.fit()", self.section)
                self.assertEqual([self.canvas(x, y) for x, y in ((10, 20), (16, 4), (25, 28))], shown)

    def test_stops_are_rings_on_one_curve(self):
        sets = self.script(
            "const c = Chart.getChart(arguments[0].querySelector('.curve-chart canvas'));"
            "return c.data.datasets.filter((d) => d.hover !== false && d.stops).map((d) => [d.label, d.stops])",
            self.section)
        self.assertIn([PATH, [16]], sets)
        self.assertEqual([label for label, _ in sets if label.startswith("path ")], [PATH])
        radius = self.script("""
            const c = Chart.getChart(arguments[0].querySelector('.curve-chart canvas'));
            const index = c.data.datasets.findIndex((d) => d.label === arguments[1]);
            return c.getDatasetMeta(index).data.map((p) => [p.$context.raw.passes, p.options.radius])""",
            self.section, PATH)
        self.assertEqual({passes for passes, size in radius if size > 5}, {16})
