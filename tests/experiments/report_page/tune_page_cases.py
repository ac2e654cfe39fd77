"""The page of a tuning: its words, its charts and its layout."""
import functools
import json
import math
import os
import subprocess
import tempfile
import unittest

from selenium.webdriver.common.by import By

import report_fixture as fixture
from report_browser import LAPTOP, PHONE, ReportCase, browser


@functools.cache
def tuned(program):
    """The folder of a small tuning; it exists until the process ends."""
    parent = tempfile.TemporaryDirectory()
    out = os.path.join(parent.name, "tuning")
    run = subprocess.run([program, "tune", f"{fixture.ROOT}/scenes/cornell-box.xml", "--target", "20%", "--minutes", "1.5",
                          "--resolution", "32x32", "--method", "photon_mapper k=50 area=surface", "--method", "path",
                          "--vary", "photons=1000..50000", "--out", out],
                         cwd=parent.name, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return parent, out, run.stdout


class TunePageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        _, cls.results, cls.printed = tuned(ReportCase.program)
        with open(os.path.join(cls.results, "tune.json"), encoding="utf-8") as file:
            cls.numbers = json.load(file)
        cls.driver = browser()

    @classmethod
    def tearDownClass(cls):
        cls.driver.quit()

    def setUp(self):
        self.open(LAPTOP)

    def tearDown(self):
        self.assertEqual([entry for entry in self.driver.get_log("browser") if entry["level"] != "INFO"], [])

    def open(self, size, scheme="light"):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size == PHONE})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.driver.get("file://" + os.path.join(self.results, "tune.html"))

    def chart(self, heading):
        return self.driver.execute_script("""
            const box = [...document.querySelectorAll(".charts > div")]
              .find((b) => b.querySelector("h3").textContent === arguments[0]);
            const chart = Chart.getChart(box.querySelector("canvas"));
            return chart && {x: chart.options.scales.x.type, y: chart.options.scales.y.type,
              ticks: chart.scales.x.ticks.map((t) => t.label),
              sets: chart.data.datasets.map((d) => d.data.map((p) => [p.x, p.y]))}""", heading)

    def test_the_label_to_paste_stands_first(self):
        label = self.printed.splitlines()[0]
        self.assertEqual(self.numbers["best"]["paste"], label)
        self.assertEqual(self.driver.find_element(By.CSS_SELECTOR, ".paste code").text, label)

    def test_a_chart_shows_every_measured_setting_over_each_parameter(self):
        method = self.numbers["methods"].index("photon_mapper k=50 area=surface")
        names = [p["name"] for p in self.numbers["tuned"][method]["parameters"]]
        headings = [h.text for h in self.driver.find_elements(By.CSS_SELECTOR, ".charts h3")]
        self.assertEqual(headings, names)
        at = names.index("photons")
        settings = [s for s in self.numbers["tuned"][method]["settings"] if s["seconds"]]
        chart = self.chart("photons")
        self.assertEqual((chart["x"], chart["y"]), ("logarithmic", "logarithmic"))
        for number, measured in ((1, True), (2, False)):
            expected = sorted([float(s["values"][at]), s["seconds"]] for s in settings if s["measured"] == measured)
            self.assertEqual(sorted(chart["sets"][number]), expected)

    def test_the_envelope_lies_below_all_measured_settings(self):
        chart = self.chart("photons")
        envelope, measured = chart["sets"][0], chart["sets"][1]
        self.assertGreater(len(measured), 3)
        for x, y in measured:
            for (x0, y0), (x1, y1) in zip(envelope, envelope[1:]):
                if x0 <= x <= x1:
                    line = y0 * (y1 / y0) ** (math.log(x / x0) / math.log(x1 / x0))
                    self.assertGreaterEqual(y, line * (1 - 1e-9))
        for point in envelope:
            self.assertIn(point, measured)

    def test_words_and_zero_have_their_places(self):
        self.assertEqual(self.chart("cache")["ticks"], ["off", "on"])
        self.assertEqual(self.chart("gather")["ticks"][0], "0")

    def test_every_size_and_scheme(self):
        grounds = set()
        for name, size in (("laptop", LAPTOP), ("phone", PHONE)):
            for scheme in ("light", "dark"):
                self.open(size, scheme)
                for place in ("header", ".tuned", "main > .scroll:last-child"):
                    self.driver.execute_script("arguments[0].scrollIntoView({block: 'start'})",
                                               self.driver.find_element(By.CSS_SELECTOR, place))
                    if ReportCase.screenshots:
                        short = place.strip(".").split(" ")[0]
                        self.driver.save_screenshot(os.path.join(ReportCase.screenshots, f"tune-{name}-{scheme}-{short}.png"))
                grounds.add(self.driver.execute_script("return getComputedStyle(document.body).backgroundColor"))
                wide = self.driver.execute_script("return document.documentElement.scrollWidth - innerWidth")
                self.assertLessEqual(wide, 0, f"{name}: the page is wider than the screen")
        self.assertEqual(len(grounds), 2)

    def test_without_scripts_the_numbers_can_be_read(self):
        self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        try:
            self.open(LAPTOP)
            text = self.driver.find_element(By.TAG_NAME, "body").text
        finally:
            self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
        for words in ("Cheapest settings: cornell-box to 20%", "One step from the cheapest settings", "halved", "doubled",
                      "the defaults"):
            self.assertIn(words, text)
