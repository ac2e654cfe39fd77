"""The strip of a report: an image of each method at equal time, before anything else."""
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

import report_fixture as fixture
from report_browser import BOX, LAPTOP, PATH, PHONE, ReportCase

DESKTOP = (1400, 900)


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

    def test_an_image_of_each_method_is_seen_without_scrolling(self):
        self.look(DESKTOP)
        self.shot("strip-desktop")
        for scheme in ("light", "dark"):
            self.look(DESKTOP, scheme)
            self.shot(f"strip-desktop-{scheme}")
            self.assertEqual({tile.get_attribute("data-method") for tile in self.tiles()[1:]}, set(fixture.METHODS))
            for canvas in self.section.find_elements(By.CSS_SELECTOR, "canvas.image"):
                box = self.script("return arguments[0].getBoundingClientRect().toJSON()", canvas)
                self.assertTrue(0 <= box["top"] < box["bottom"] <= DESKTOP[1], box)
                self.assertGreater(box["width"], 100)

    def test_each_tile_has_its_line(self):
        table = {row["method"]: row for row in fixture.rows(self.results, "table.csv")
                 if row["scene"] == BOX and row["component"] == "total"}
        texts = {tile.get_attribute("data-method"): tile.text for tile in self.tiles()[1:]}
        for method, text in texts.items():
            self.assertRegex(text, r"\d %, FLIP 0\.\d\d\d|no image yet; first after [\d.]+ s")
            self.assertRegex(text, "noise|bias")
            for effect in filter(None, table[method]["effects_missing"].split(";")):
                self.assertIn(effect.replace("_", " "), text)
        self.assertIn("noise: the method is unbiased", texts[PATH])
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

    def test_the_keyboard_opens_the_viewer(self):
        link = self.tile(PATH).find_element(By.CSS_SELECTOR, "a.picture")
        link.send_keys(Keys.ENTER)
        self.settle()
        self.assertEqual(self.driver.switch_to.active_element, self.stage)
        self.assertIn("A: " + PATH, self.label())

    def test_two_methods_or_forty_fit_every_screen(self):
        for count in (2, 40):
            for name, size in (("phone", PHONE), ("narrow", (400, 800)), ("laptop", LAPTOP), ("desktop", DESKTOP)):
                self.look(size)
                self.script("""
                    const [strip, count] = [arguments[0].querySelector(".strip"), arguments[1]];
                    const tiles = [...strip.children];
                    for (const tile of tiles.slice(count + 1)) tile.remove();
                    for (let i = tiles.length; i < count + 1; ++i) strip.append(tiles[1].cloneNode(true));
                    strip.classList.toggle("many", count > 8)""", self.section, count)
                self.assert_fits(f"{count} methods, {name}")
                self.shot(f"strip-{count}-{name}")
                for tile in self.tiles():
                    box = self.script("return arguments[0].getBoundingClientRect().toJSON()", tile)
                    self.assertGreater(box["width"], 90, f"{count} methods, {name}")

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

    def test_tables_are_folded_and_open(self):
        folded = self.section.find_elements(By.CSS_SELECTOR, "details.folded")
        self.assertGreater(len(folded), 4)
        self.assertFalse(any(details.get_attribute("open") for details in folded))
        noise = next(d for d in folded if d.find_element(By.TAG_NAME, "summary").text == "Bias and noise")
        self.scroll_to(noise)
        noise.find_element(By.TAG_NAME, "summary").click()
        canvas = noise.find_element(By.CSS_SELECTOR, ".noise-chart canvas")
        self.wait(lambda: canvas.size["height"] > 200, "the chart fits when its table is opened")
        self.shot("noise-opened")
