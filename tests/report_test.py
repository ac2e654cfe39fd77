"""Clicks through report.html in headless Chromium: report_test.py GIBENCH [folder for screenshots]. Exit 77: skipped."""
import math
import os
import shutil
import sys
import tempfile
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    print("skipped: python3-selenium is not installed (scripts/setup scripts/packages-report.txt)")
    sys.exit(77)
for needed in ("chromium", "chromedriver", "oiiotool"):
    if not shutil.which(needed):
        print(f"skipped: {needed} is not installed (scripts/setup scripts/packages-report.txt)")
        sys.exit(77)

import report_fixture as fixture

LAPTOP, PHONE = (1366, 768), (390, 844)
HALF = 2.0 ** -10  # twice what a half float is rounded by: totals are sums of rounded components
PATH, PHOTONS = fixture.METHODS[0], fixture.METHODS[1]
BOX = "cornell-box"


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--force-color-profile=srgb",
                     "--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=1366,768"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.parent = tempfile.TemporaryDirectory()
        cls.shots = SCREENSHOTS or cls.parent.name
        os.makedirs(cls.shots, exist_ok=True)
        cls.results = fixture.make_results(PROGRAM, cls.parent.name)
        cls.images = os.path.join(cls.results, "images")
        cls.driver = browser()

    @classmethod
    def tearDownClass(cls):
        cls.driver.quit()
        cls.parent.cleanup()

    def setUp(self):
        self.open(LAPTOP)

    def tearDown(self):
        # Anything that is not there, that is blocked, or that throws.
        self.assertEqual([entry for entry in self.driver.get_log("browser") if entry["level"] != "INFO"], [])

    def open(self, size, scheme="light", scene=0):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size == PHONE})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.driver.get("file://" + os.path.join(self.results, "report.html"))
        self.section = self.driver.find_element(By.ID, f"scene-{scene}")
        self.scroll_to(self.section.find_element(By.CSS_SELECTOR, ".viewer"))
        self.wait(lambda: self.section.find_elements(By.CSS_SELECTOR, ".stage"), "the viewer is made when it is near")
        self.stage = self.section.find_element(By.CSS_SELECTOR, ".stage")
        self.settle()

    def wait(self, condition, what):
        WebDriverWait(self.driver, 20, 0.02).until(lambda _: condition(), what)

    def settle(self):
        self.wait(lambda: self.stage.get_attribute("aria-busy") == "false", "the viewer's images are there")

    def scroll_to(self, element):
        self.driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)

    def shot(self, name):
        self.driver.save_screenshot(os.path.join(self.shots, name + ".png"))

    # Controls by their names, as a reader of the screen finds them.

    def control(self, name, within=".viewer"):
        """The <select> or slider with this label."""
        for label in self.section.find_elements(By.CSS_SELECTOR, f"{within} label"):
            if label.text == name and label.get_attribute("for"):
                return self.driver.find_element(By.ID, label.get_attribute("for"))
        raise AssertionError(f"no control is named {name}")

    def choose(self, name, text, within=".viewer"):
        Select(self.control(name, within)).select_by_visible_text(text)
        self.settle()

    def press(self, text, within=".viewer"):
        """A radio button or a button by its text."""
        for found in self.section.find_elements(By.CSS_SELECTOR, f"{within} .choice .bar label, {within} button"):
            if found.text == text and found.is_displayed():
                self.scroll_to(found)
                found.click()
                self.settle()
                return
        raise AssertionError(f"no button is named {text}")

    def keys(self, element, *keys):
        for key in keys:
            element.send_keys(key)
        self.settle()

    def focus_stage(self):
        self.scroll_to(self.stage)
        self.driver.execute_script("arguments[0].focus()", self.stage)

    def go_to(self, x, y):
        """Moves the cursor by keys, from wherever it is."""
        self.focus_stage()
        start = self.where()
        if start is None:
            self.stage.send_keys(Keys.ARROW_RIGHT)
            start = self.where()
        for count, more, less in ((x - start[0], Keys.ARROW_RIGHT, Keys.ARROW_LEFT),
                                  (y - start[1], Keys.ARROW_DOWN, Keys.ARROW_UP)):
            if count:
                self.stage.send_keys((more if count > 0 else less) * abs(count))
        self.assertEqual(self.where(), (x, y))

    def where(self):
        found = self.section.find_elements(By.CSS_SELECTOR, ".values .where")
        if not found:
            return None
        x, y = found[0].text.replace("x ", "").split(", y ")
        return int(x), int(y)

    def values(self, side):
        text = self.section.find_element(By.CSS_SELECTOR, f".value[data-side={side}]").text
        return [float(v.rstrip("%").replace("−", "-")) for v in text[1:].replace("%", " ").split()]

    def canvas(self, x, y):
        """The colour of the stage's canvas at the centre of an image's pixel."""
        return self.driver.execute_script("""
            const [section, x, y] = arguments;
            const stage = section.panel.stage, scale = stage.ratio;
            const at = (offset, v) => Math.floor((offset + (v + 0.5) * stage.zoom) * scale);
            const one = new OffscreenCanvas(1, 1).getContext("2d", {willReadFrequently: true});
            one.drawImage(stage.canvas, -at(stage.x, x), -at(stage.y, y));
            return [...one.getImageData(0, 0, 1, 1).data]
        """, self.section, x, y)[:3]

    def assert_pixel(self, found, expected):
        for one, other in zip(found, expected):
            self.assertLessEqual(abs(one - other), HALF * abs(other) + 1e-4 * abs(other) + 1e-6, f"{found}: {expected}")

    # The viewer

    def test_values_are_those_of_the_files(self):
        method = fixture.pixels(os.path.join(self.images, f"{BOX}-path_spp=64.exr"))
        reference = fixture.pixels(os.path.join(self.images, f"{BOX}-reference.exr"))
        for x, y in ((3, 4), (16, 2), (20, 27), (31, 31)):
            self.go_to(x, y)
            self.assert_pixel(self.values("A"), method[x, y])
            self.assert_pixel(self.values("B"), reference[x, y])

    def test_components_are_those_of_the_files(self):
        seen = []
        for component in ("direct", "indirect"):
            self.choose("Component", component)
            self.go_to(10, 20)
            expected = fixture.pixels(os.path.join(self.images, f"{BOX}-path_spp=64.exr"), component)[10, 20]
            self.assert_pixel(self.values("A"), expected)
            seen.append(self.values("A"))
        self.assertNotEqual(seen[0], seen[1])

    def test_every_method_can_be_chosen_on_both_sides(self):
        self.go_to(12, 25)
        for method in fixture.METHODS:
            name = method.replace(" ", "_")
            expected = fixture.pixels(os.path.join(self.images, f"{BOX}-{name}.exr"))[12, 25]
            for side in "AB":
                self.choose(side, method)
                self.assert_pixel(self.values(side), expected)
        self.choose("A", "reference")
        self.assertIn("reference", self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text)

    def test_flip_shows_the_other_image(self):
        self.choose("A", PHOTONS)
        self.go_to(14, 26)
        shown = {}
        for label in ("A: " + PHOTONS, "B: reference", "A: " + PHOTONS):
            self.assertIn(label, self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text)
            side = label[0]
            exposure = self.driver.execute_script("return 2 ** arguments[0].panel.state.stops", self.section)
            found = self.canvas(14, 26)
            for byte, value in zip(found, self.values(side)):
                self.assertLessEqual(abs(byte - fixture.srgb(value * exposure)), 1.5)
            self.assertEqual(shown.setdefault(side, found), found)
            self.keys(self.stage, Keys.SPACE)
        self.assertNotEqual(shown["A"], shown["B"])
        self.press("Flip to A")
        self.assertIn("A: ", self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text)

    def test_slide_shows_both_at_the_split(self):
        self.choose("A", PHOTONS)
        self.go_to(16, 26)
        a = self.canvas(16, 26)
        self.keys(self.stage, Keys.SPACE)
        b = self.canvas(16, 26)
        self.assertNotEqual(a, b)
        self.press("slide")
        split = self.control("Split")
        for key, expected in ((Keys.HOME, b), (Keys.END, a)):
            self.keys(split, key)
            self.assertEqual(self.canvas(16, 26), expected)
        self.assertEqual(split.get_attribute("aria-valuetext"), "100 %")
        self.keys(split, Keys.ARROW_LEFT)
        self.assertEqual(split.get_attribute("aria-valuetext"), "99 %")
        self.focus_stage()
        self.keys(self.stage, "[")
        self.assertEqual(split.get_attribute("aria-valuetext"), "94 %")
        # By hand: from where the divider is to the middle of the stage.
        width = self.stage.size["width"]
        ActionChains(self.driver).move_to_element_with_offset(self.stage, round(0.44 * width), 0).click_and_hold() \
            .move_to_element(self.stage).release().perform()
        self.assertIn(split.get_attribute("aria-valuetext"), ("49 %", "50 %", "51 %"))

    def test_a_stop_doubles_what_is_shown(self):
        self.go_to(8, 24)
        slider = self.control("Exposure")
        self.keys(slider, *[Keys.ARROW_LEFT] * 8)
        dark = [fixture.linear(v) for v in self.canvas(8, 24)]
        values = self.values("A")
        self.keys(slider, *[Keys.ARROW_RIGHT] * 4)
        bright = [fixture.linear(v) for v in self.canvas(8, 24)]
        self.assertEqual(slider.get_attribute("aria-valuetext"), "-1 stop")
        self.assertLess(max(bright), 0.99, "nothing is clipped")
        for one, other in zip(dark, bright):
            step = (other + 0.055) * 2.4 / 255 * 1.5  # one and a half of 8 bits, at this brightness
            self.assertLess(abs(other - 2 * one), 1.5 * step)
        self.assertEqual(self.values("A"), values, "values are radiance, whatever the exposure")
        self.focus_stage()
        self.keys(self.stage, ".")
        self.assertEqual(slider.get_attribute("aria-valuetext"), "-0.5 stops")
        self.press("Reset")
        self.assertEqual(slider.get_attribute("aria-valuetext"), "0 stops")

    def test_time_chooses_the_image_that_fits_into_it(self):
        self.go_to(9, 22)
        final = self.values("A")
        slider = self.control("Time")
        self.assertIn("final images", slider.get_attribute("aria-valuetext"))
        self.choose("A", PATH)
        times = self.driver.execute_script("return arguments[0].panel.sources.times", self.section)
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
        image = fixture.pixels(os.path.join(self.images, f"{BOX}-path_spp=64.exr"))[x, y]
        r = fixture.pixels(os.path.join(self.images, f"{BOX}-reference.exr"))[x, y]
        scale = [math.sqrt(v * v + 0.01) for v in r]
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
        self.assertAlmostEqual(self.values("A")[0], 100 * bias, delta=0.02 + 1e-2 * abs(bias))
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
        mean = self.driver.execute_script(
            "const v = arguments[0].panel.stage.sides[0].map.values; return v.reduce((a, b) => a + b) / v.length", self.section)
        folder = fixture.cell_folder(self.results, BOX, PATH, 1)
        with open(os.path.join(folder, "flip.json"), encoding="utf-8") as file:
            self.assertAlmostEqual(mean, float(file.read().split(":")[1].rstrip("}\n ")), delta=2 / 255)

    def test_zoom_and_pan_keep_the_pixel_under_the_pointer(self):
        self.focus_stage()
        stage = "const stage = arguments[0].panel.stage; return "
        fit = self.driver.execute_script(stage + "stage.zoom", self.section)
        self.press("+")
        self.assertAlmostEqual(self.driver.execute_script(stage + "stage.zoom", self.section), 1.5 * fit)
        self.focus_stage()
        ActionChains(self.driver).move_to_element_with_offset(self.stage, 30, 20).perform()
        before = self.where()
        ActionChains(self.driver).move_to_element_with_offset(self.stage, 30, 20).click_and_hold() \
            .move_by_offset(70, -40).release().perform()
        ActionChains(self.driver).move_to_element_with_offset(self.stage, 100, -20).perform()
        self.assertEqual(self.where(), before)
        self.press("1:1")
        self.assertEqual(self.driver.execute_script(stage + "stage.zoom", self.section), 1)
        self.keys(self.stage, "0")
        self.assertAlmostEqual(self.driver.execute_script(stage + "stage.zoom", self.section), fit)
        self.keys(self.stage, "-")
        self.assertLess(self.driver.execute_script(stage + "stage.zoom", self.section), fit)

    # The charts

    def chart(self, place):
        return self.driver.execute_script(
            "const c = Chart.getChart(arguments[0].querySelector(arguments[1] + ' canvas'));"
            "return c ? c.data.datasets.map((d) => ({label: d.label, hover: d.hover, data: d.data})) : null",
            self.section, place)

    def points(self, method, place=".curve-chart"):
        found = [set for set in self.chart(place) if set["label"] == method and set["hover"] is not False]
        return [(p["x"], p["y"]) for p in found[0]["data"]] if found else None

    def test_curves_are_those_of_the_table(self):
        for metric, column, factor in (("relative RMSE", "rel_mse", 100), ("RMSE", "mse", 1)):
            self.press(metric, ".scene-controls")
            rows = [row for row in fixture.rows(self.results, "curves.csv")
                    if (row["scene"], row["method"]) == (BOX, PATH)]
            expected = []
            for passes in sorted({int(row["pass"]) for row in rows}):
                at = [row for row in rows if int(row["pass"]) == passes]
                expected.append((sum(float(row["seconds"]) for row in at) / 3,
                                 factor * math.sqrt(sum(float(row[column]) for row in at) / 3)))
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

    def test_hovering_says_value_interval_and_passes(self):
        canvas = self.section.find_element(By.CSS_SELECTOR, ".curve-chart canvas")
        self.scroll_to(canvas)
        x, y = self.driver.execute_script("""
            const chart = Chart.getChart(arguments[0]);
            const point = chart.getDatasetMeta(0).data[2];
            return [point.x - chart.width / 2, point.y - chart.height / 2]""", canvas)
        ActionChains(self.driver).move_to_element_with_offset(canvas, round(x), round(y)).perform()
        lines = self.driver.execute_script(
            "const t = Chart.getChart(arguments[0]).tooltip; return t.opacity > 0 ? t.body.flatMap((b) => b.lines) : []", canvas)
        self.assertIn(PATH, lines)
        self.assertRegex(" ".join(lines), r"[\d.]+ \([\d.]+ to [\d.]+\) after [\d.e-]+ s 3 passes")
        self.shot("hover")

    # The page

    def test_every_size_and_scheme(self):
        grounds = set()
        for name, size in (("laptop", LAPTOP), ("phone", PHONE)):
            for scheme in ("light", "dark"):
                self.open(size, scheme)
                self.driver.execute_script("scrollTo(0, 0)")
                self.shot(f"{name}-{scheme}-top")
                for place in (".scene-controls", ".curve-chart", ".viewer", ".stages"):
                    self.driver.execute_script("arguments[0].scrollIntoView({block: 'start'})",
                                               self.section.find_element(By.CSS_SELECTOR, place))
                    self.settle()
                    self.shot(f"{name}-{scheme}-{place[1:]}")
                self.press("slide")
                self.focus_stage()
                self.shot(f"{name}-{scheme}-slide")
                grounds.add(self.driver.execute_script("return getComputedStyle(document.body).backgroundColor"))
                wide = self.driver.execute_script("return document.documentElement.scrollWidth - innerWidth")
                self.assertLessEqual(wide, 0, f"{name}: the page is wider than the screen")
                self.assertEqual(self.clipped(), [], name)
                lines = self.driver.execute_script(
                    "const c = Chart.getChart(arguments[0].querySelector('.curve-chart canvas'));"
                    "return c.data.datasets[0].borderColor", self.section)
                self.assertEqual(lines, {"light": "#1f6fd6", "dark": "#62a5ff"}[scheme])
        self.assertEqual(len(grounds), 2)

    def clipped(self):
        """Texts that are wider than the elements that hold them, or that leave the screen."""
        return self.driver.execute_script("""
            const found = [];
            for (const e of document.querySelectorAll("button, label, select, legend, h1, h2, h3, p, li, .stage-label")) {
              const box = e.getBoundingClientRect();
              if (box.width === 0) continue;
              if (e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).display !== "inline" && e.tagName !== "SELECT")
                found.push("cut: " + e.textContent);
              if (box.left < -0.5 || box.right > innerWidth + 0.5) found.push("outside: " + e.textContent);
            }
            return found""")

    def test_colours_follow_a_change_of_scheme(self):
        color = "return Chart.getChart(arguments[0].querySelector('.curve-chart canvas')).data.datasets[0].borderColor"
        before = self.driver.execute_script(color, self.section)
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": "dark"}]})
        self.wait(lambda: self.driver.execute_script(color, self.section) != before, "charts are drawn again")

    def test_the_keyboard_reaches_every_control_and_shows_where_it_is(self):
        self.open(LAPTOP, scene=1)  # both viewers are there
        self.driver.execute_script("document.activeElement.blur(); scrollTo(0, 0)")
        body = self.driver.find_element(By.TAG_NAME, "body")
        body.send_keys(Keys.TAB)
        reached, unmarked = set(), []
        for _ in range(200):
            info = self.driver.execute_script("""
                const e = document.activeElement;
                if (!e || e === document.body) return null;
                e.dataset.reached = "yes";
                const mark = e.type === "radio" ? e.nextElementSibling : e;
                const style = getComputedStyle(mark);
                return [e.outerHTML.slice(0, 80), style.outlineStyle, parseFloat(style.outlineWidth)]""")
            if info is None:
                break
            reached.add(info[0])
            if info[1] == "none" or info[2] < 2:
                unmarked.append(info[0])
            self.driver.switch_to.active_element.send_keys(Keys.TAB)
        missed = self.driver.execute_script("""
            return [...document.querySelectorAll("button, select, input, a[href], summary, [tabindex='0']")]
              .filter((e) => !e.dataset.reached && !e.disabled && e.checkVisibility() && !(e.type === "radio" && !e.checked))
              .map((e) => e.outerHTML.slice(0, 80))""")
        self.assertEqual((missed, unmarked), ([], []))
        self.assertGreater(len(reached), 20)

    def test_every_control_has_a_name(self):
        nodes = self.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
        roles = {"button", "combobox", "slider", "radio", "application", "region", "link", "img", "group"}
        nameless = [node["role"]["value"] for node in nodes if not node.get("ignored") and
                    node.get("role", {}).get("value") in roles and not node.get("name", {}).get("value")]
        self.assertEqual([role for role in nameless if role != "group"], [])
        found = {node.get("role", {}).get("value") for node in nodes}
        self.assertLessEqual({"button", "combobox", "slider", "radio", "application", "region"}, found)

    def test_without_scripts_the_numbers_can_be_read(self):
        self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        try:
            self.driver.get("file://" + os.path.join(self.results, "report.html"))
            text = self.driver.find_element(By.TAG_NAME, "body").text
        finally:
            self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
        for words in ("A test of the report: <b>&amp; co", "Price list", "cheapest", "indirect", PHOTONS, "Where the time goes"):
            self.assertIn(words, text)

    def test_the_other_scene_has_its_own_images(self):
        self.open(LAPTOP, scene=1)
        self.go_to(15, 18)
        expected = fixture.pixels(os.path.join(self.images, "cornell-glass-path_spp=64.exr"))[15, 18]
        self.assert_pixel(self.values("A"), expected)
        self.choose("Component", "caustic")
        self.choose("A", fixture.METHODS[2])
        self.assertIn("does not simulate", self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv[1])
    SCREENSHOTS = os.environ.get("GIB_SCREENSHOTS", "")
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:])
