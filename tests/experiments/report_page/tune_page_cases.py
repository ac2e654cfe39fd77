"""The page of a tuning: its words, its charts and its layout."""
import functools
import json
import os
import re
import subprocess
import tempfile

from selenium.webdriver.common.by import By

import report_fixture as fixture
from browser_case import BrowserCase, LAPTOP


METHOD = "photon_mapper photons=1000 area=plain gather=8 cache=on accuracy=0.5 direct_samples=1"  # only k varies
# Settings as (photons, gather, cache, seconds, measured); times that a run finds would depend on the machine.
SETTINGS = [(1e3, 0, None, 9.0, True), (1e4, 16, "off", 4.0, True), (2e4, 32, "on", 1.5, True), (5e4, 64, "on", 1.0, True),
            (1e5, 64, "on", 2.5, True), (2e5, 0, None, 1.2, True), (1e6, 512, "off", 7.0, True), (3e4, 16, "on", 0.5, False),
            (4e5, 256, "off", 11.0, False), (1e4, 512, "on", None, False)]


def known_numbers(numbers):
    """The numbers of a report with these settings as those of its search."""
    method = numbers["tuning"]["methods"][0]
    method["settings"] = [{"label": f"{METHOD} {i}", "values": [photons, gather, cache], "seconds": seconds,
                           "measured": measured} for i, (photons, gather, cache, seconds, measured) in enumerate(SETTINGS)]
    method["parameters"] = [{"name": name, "unit": unit, "sentence": "", "words": words} for name, unit, words in
                            (("photons", "photons", None), ("gather", "rays", None), ("cache", "", ["off", "on"]))]
    method["label"] = f"{METHOD} 3"
    return numbers


@functools.cache
def tuned(program):
    """The folder of a small tuning; it exists until the process ends."""
    parent = tempfile.TemporaryDirectory()
    out = os.path.join(parent.name, "tuning")
    run = subprocess.run([program, "tune", f"{fixture.ROOT}/scenes/cornell-box.xml", "--target", "90%", "--minutes", "0.4",
                          "--resolution", "16x16", "--method", METHOD, "--out", out],
                         cwd=parent.name, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    with open(os.path.join(out, "report.html"), encoding="utf-8") as file:
        page = file.read()
    data = re.compile(r'(id="report-data">)(.*?)(</script>)', re.DOTALL)
    numbers = json.dumps(known_numbers(json.loads(data.search(page).group(2))))
    with open(os.path.join(out, "known.html"), "w", encoding="utf-8") as file:
        file.write(data.sub(lambda found: found.group(1) + numbers + found.group(3), page, count=1))
    return parent, out, run.stdout


class TunePageTest(BrowserCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        _, cls.results, cls.printed = tuned(cls.program)
        with open(os.path.join(cls.results, "tune.json"), encoding="utf-8") as file:
            cls.numbers = json.load(file)

    def setUp(self):
        self.open(LAPTOP)

    def open(self, size, scheme="light", page="known.html"):
        self.load(os.path.join(self.results, page), size, scheme)

    def chart(self, heading):
        return self.script("""
            const box = [...document.querySelectorAll(".tuned .charts > div")]
              .find((b) => b.querySelector("h3").textContent === arguments[0]);
            const chart = Chart.getChart(box.querySelector("canvas"));
            return chart && {x: chart.options.scales.x.type, y: chart.options.scales.y.type,
              ticks: chart.scales.x.ticks.map((t) => t.label),
              sets: chart.data.datasets.map((d) => d.data.map((p) => [p.x, p.y]))}""", heading)

    def test_the_label_to_paste_stands_first(self):
        self.open(LAPTOP, page="report.html")
        label = self.printed.splitlines()[0]
        self.assertEqual(self.numbers["methods"][self.numbers["best"]]["paste"], label)
        self.assertEqual(self.driver.find_element(By.CSS_SELECTOR, ".paste code").text, label)
        self.assertEqual([h.text for h in self.driver.find_elements(By.CSS_SELECTOR, ".tuned .charts h3")], ["k"])
        self.assertTrue(any(self.chart("k")["sets"]), "the settings of the search are there")

    def test_a_chart_shows_every_setting_that_reaches_the_target_over_each_parameter(self):
        headings = [h.text for h in self.driver.find_elements(By.CSS_SELECTOR, ".tuned .charts h3")]
        self.assertEqual(headings, ["photons", "gather", "cache"])
        chart = self.chart("photons")
        self.assertEqual((chart["x"], chart["y"]), ("logarithmic", "logarithmic"))
        for number, measured in ((0, True), (1, False)):
            expected = [[s[0], s[3]] for s in SETTINGS if s[4] == measured and s[3]]
            self.assertEqual(chart["sets"][number], expected)
        self.assertEqual(chart["sets"][2], [[5e4, 1.0]], "the best one has a ring")

    def test_words_and_zero_have_their_places(self):
        self.assertEqual(self.chart("cache")["ticks"], ["off", "on"])
        self.assertEqual(sorted(p[0] for p in self.chart("cache")["sets"][0]), [0, 0, 1, 1, 1])
        self.assertEqual(self.chart("gather")["ticks"][0], "0")
        self.assertEqual(min(p[0] for p in self.chart("gather")["sets"][0]), 8, "half the least number of rays")

    def test_without_scripts_the_numbers_can_be_read(self):
        text = self.text_without_scripts(os.path.join(self.results, "report.html"))
        for words in ("The cheapest settings for 90%", "Labels for", "measured", "seconds to 90%"):
            self.assertIn(words, text)
