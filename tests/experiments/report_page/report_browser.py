"""A report in headless Chromium: opens it, finds its controls by their names, and reads what it shows."""
import os

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait

import report_fixture as fixture
from browser_case import BrowserCase, LAPTOP

HALF = 2.0 ** -10  # twice the rounding of a half float: totals are sums of rounded components
PATH, PHOTONS = fixture.METHODS[0], fixture.METHODS[1]
BOX = "cornell-box"


class ReportCase(BrowserCase):
    """Tests share one result folder and one browser; each opens the page anew."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.results = fixture.shared_results(cls.program)
        cls.images = os.path.join(cls.results, "images")

    def setUp(self):
        self.open(LAPTOP)

    def open(self, size, scheme="light", scene=0):
        self.load(os.path.join(self.results, "report.html"), size, scheme)
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
        self.script("arguments[0].scrollIntoView({block: 'center'})", element)

    def pixels(self, name, layer=""):
        """The pixels of an image of the cornell box: {(x, y): (r, g, b)}."""
        return fixture.pixels(os.path.join(self.images, f"{BOX}-{name.replace(' ', '_')}.exr"), layer)

    def label(self):
        """The stage's label at the left."""
        return self.section.find_element(By.CSS_SELECTOR, ".stage-label.left").text

    # Controls are found by their names, as a user of the page finds them.

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
        self.script("arguments[0].focus()", self.stage)

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
        text = self.section.find_element(By.CSS_SELECTOR, f".value[data-side='{side}']").text
        return [float(v.rstrip("%").replace("−", "-")) for v in text[len(side):].replace("%", " ").replace("±", " ").split()]

    def canvas(self, x, y, cell=0):
        """The colour of the stage's canvas at the centre of an image's pixel, in a cell of the grid."""
        return self.script("""
            const [section, x, y, index] = arguments;
            const stage = section.panel.stage, scale = stage.ratio, {width, height, columns} = stage.cell;
            const at = (offset, v) => Math.floor((offset + (v + 0.5) * stage.zoom) * scale);
            const left = index % columns * width, top = Math.floor(index / columns) * height;
            const one = new OffscreenCanvas(1, 1).getContext("2d", {willReadFrequently: true});
            one.drawImage(stage.canvas, -at(left + stage.x, x), -at(top + stage.y, y));
            return [...one.getImageData(0, 0, 1, 1).data]
        """, self.section, x, y, cell)[:3]

    def assert_pixel(self, found, expected):
        for one, other in zip(found, expected):
            self.assertLessEqual(abs(one - other), HALF * abs(other) + 1e-4 * abs(other) + 1e-6, f"{found}: {expected}")
