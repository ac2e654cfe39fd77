"""Clicks through pages of `gibench photons` in headless Chromium: photons_test.py GIBENCH [options of unittest].

Screenshots go to the folder that the variable GIB_SCREENSHOTS names. Exit code 77: skipped.
"""
import json
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

import browser_case  # noqa: E402  found by the line above
from browser_case import BrowserCase, ROOT  # noqa: E402
from photons_pages import PAGES, Page  # noqa: E402
from selenium import webdriver  # noqa: E402
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402
from selenium.webdriver.support.ui import Select, WebDriverWait  # noqa: E402

LAPTOP, PHONE = (1400, 900), (400, 800)


class PhotonsCase(BrowserCase):
    # SwiftShader draws WebGL without a graphics processor.
    graphics = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
    logs = ("browser", "performance")
    phone = PHONE
    pages = {}

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        PhotonsCase.pages.clear()

    def tearDown(self):
        super().tearDown()
        asked = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        urls = [message["params"]["request"]["url"] for message in asked
                if message["method"] == "Network.requestWillBeSent"]
        self.assertEqual([url for url in urls if not url.startswith(("file://", "data:"))], [], "network requests")

    def open(self, name, size=LAPTOP, scheme="light"):
        if name not in self.pages:
            self.pages[name] = Page(self.program, self.parent.name, name)
        self.driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": size == PHONE})
        self.load(self.pages[name].path, size, scheme)
        self.stage = self.find("#stage")
        WebDriverWait(self.driver, 60, 0.05).until(lambda _: self.stage.get_attribute("data-ready"), "the page starts")
        self.settle()
        return self.pages[name]

    def settle(self):
        """Waits until the frame that is due has been drawn."""
        self.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")

    def shown(self):
        return self.find("#shown").text

    def visible(self):
        """The number of photons that the page says it shows."""
        return int(re.search(r"([\d,]+) of [\d,]+ photons", self.shown())[1].replace(",", ""))

    def count_bytes(self, code):
        """What `code` returns of the `bytes` (RGBA) that the stage draws."""
        return self.script("""
            const view = arguments[0].view;
            view.draw();
            const gl = view.renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
            const bytes = new Uint8Array(4 * w * h);
            gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);""" + code, self.stage)

    def drawn(self):
        """The number of pixels of the stage that differ from its ground."""
        return self.count_bytes("""
            let found = 0;
            for (let i = 0; i < bytes.length; i += 4)
              if (Math.abs(bytes[i] - bytes[0]) + Math.abs(bytes[i + 1] - bytes[1]) > 4) found++;
            return found""")

    def control(self, name):
        for label in self.driver.find_elements(By.CSS_SELECTOR, "#panel label"):
            if label.text.split("\n")[0] == name:
                name = label.get_attribute("for")
                return self.find(f"#{name}") if name else label.find_element(By.CSS_SELECTOR, "input")
        raise AssertionError(f"no control is named {name}")

    def check(self, name):
        self.control(name).click()
        self.settle()

    def choose(self, name, text):
        Select(self.control(name)).select_by_visible_text(text)
        self.settle()

    def slide(self, name, steps):
        self.control(name).send_keys((Keys.ARROW_RIGHT if steps > 0 else Keys.ARROW_LEFT) * abs(steps))
        self.settle()

    def camera(self):
        return self.script("return arguments[0].view.camera.position.toArray()", self.stage)


class PhotonTest(PhotonsCase):
    def test_maps_can_be_left_out(self):
        page = self.open("fog")
        self.assertEqual([one["name"] for one in page.facts["maps"]], ["global", "caustic", "volume"])
        self.assertEqual(self.visible(), len(page.maps))
        self.choose("Draw them", "hidden")
        everything = self.drawn()
        self.check("volume map")
        self.assertEqual(self.visible(), page.maps.count(0) + page.maps.count(1))
        self.assertLess(self.drawn(), 0.8 * everything)
        self.check("global map")
        self.check("caustic map")
        self.assertEqual(self.visible(), 0)
        self.assertEqual(self.drawn(), 0)
        self.check("caustic map")
        self.assertEqual(self.visible(), page.maps.count(1))
        self.assertGreater(self.drawn(), 0)

    def test_beams_are_lines_that_can_be_left_out(self):
        page = self.open("beams")
        beams = page.facts["beams"]
        self.assertGreater(beams["shown"], 100)
        self.assertEqual(len(page.array("beam-ends", "6f")), beams["shown"])
        self.assertIn(f"{beams['shown']:,} beams", self.shown())
        self.assertIn(f"all {beams['stored']:,} on this page", self.find("#beams").text)
        self.choose("Draw them", "hidden")
        for one in page.facts["maps"]:
            self.check(f"{one['name']} map")
        self.assertGreater(self.drawn(), 1000)
        self.assertEqual(int(self.stage.get_attribute("data-calls")), 1)
        self.check("lines")
        self.assertEqual(self.drawn(), 0)
        self.assertIn("no beams", self.shown())

    def test_emitted_photons_are_told_by_what_they_are_for(self):
        page = self.open("beams")
        text = self.find("#maps").text
        emitted = int(re.search(r"([\d,]+) photons emitted: ", text)[1].replace(",", ""))
        parts = re.search(r"photons emitted: (.*?)\. Powers", text)[1].split(", ")
        counts = {what: int(count.replace(",", "")) for count, what in (part.split(" ", 1) for part in parts)}
        self.assertEqual(sum(counts.values()), emitted)
        self.assertEqual(counts["for the global map"], 4000)
        self.assertEqual(counts["for the beams"], 400)
        self.assertEqual(emitted, page.facts["estimates"]["emitted"])

    def test_sliders_of_bounces_filter(self):
        page = self.open("fog")
        most = max(page.bounces)
        self.slide("Most bounces", -(most - 2))
        self.assertEqual(self.visible(), sum(b <= 2 for b in page.bounces))
        self.slide("Least bounces", 2)
        self.assertEqual(self.visible(), page.bounces.count(2))
        self.choose("Draw them", "hidden")
        few = self.drawn()
        self.assertGreater(few, 0)
        self.slide("Least bounces", 1)  # the upper end gives way
        self.assertEqual(self.visible(), page.bounces.count(3))
        self.assertNotEqual(self.drawn(), few)

    def test_colours(self):
        self.open("rainbow")
        self.choose("Draw them", "hidden")
        self.assertEqual(Select(self.control("Colour")).first_selected_option.text, "wavelength")
        self.assertIn("nm", self.find("#legend").text)
        hues = {}
        for name in ("wavelength", "power", "bounces", "the light's own"):
            self.choose("Colour", name)
            hues[name] = self.count_bytes("""
                const sums = [0, 0, 0];
                for (let i = 0; i < bytes.length; i++) if (i % 4 < 3) sums[i % 4] += bytes[i] - bytes[i % 4];
                return sums""")
        self.assertEqual(len({tuple(sums) for sums in hues.values()}), 4)

    def test_one_draw_call_holds_all_photons(self):
        self.open("fog")
        self.choose("Draw them", "hidden")
        self.assertEqual(int(self.stage.get_attribute("data-calls")), 1)

    def test_a_click_tells_the_photon(self):
        self.open("passes")
        self.choose("Draw them", "hidden")
        place = self.script("""
            const {view, layers} = arguments[0], i = 7, p = layers.photons.positions;
            const at = view.camera.position.clone().fromArray(p, 3 * i).project(view.camera);
            return [at.x, at.y]""", self.stage)
        size = self.stage.size
        ActionChains(self.driver).move_to_element_with_offset(
            self.stage, round(place[0] * size["width"] / 2), round(-place[1] * size["height"] / 2)).click().perform()
        picked = self.find("#picked").text
        self.assertRegex(picked, r"Photon of the global map, \d+ bounces\npower")


class EstimateTest(PhotonsCase):
    """The page of `estimates`, whose film has 32 x 32 pixels, against images of the same settings."""

    def click_pixel(self, x, y):
        """Clicks the place that the middle of a pixel sees, and returns the table: {name: numbers}."""
        columns = self.page.facts["estimate"]["grid"][0]
        place = self.script("""
            const {view, layers} = arguments[0], at = layers.estimates.pointOf(arguments[1]).project(view.camera);
            return [at.x, at.y]""", self.stage, y * columns + x)
        size = self.stage.size
        ActionChains(self.driver).move_to_element_with_offset(
            self.stage, round(place[0] * size["width"] / 2), round(-place[1] * size["height"] / 2)).click().perform()
        rows = [row.text.split() for row in self.driver.find_elements(By.CSS_SELECTOR, "#estimate-table tr")]
        return {name: tuple(map(float, values)) for name, *values in rows}

    def image(self, *arguments):
        """{layer: {(x, y): (r, g, b)}} of an image that gibench makes."""
        path = os.path.join(self.parent.name, "image.exr")
        subprocess.run([self.program, *arguments, "-o", path], capture_output=True, check=True)
        said = subprocess.run(["oiiotool", "--info", "-v", "--dumpdata", path], capture_output=True, text=True, check=True).stdout
        names, layers = re.search(r"channel list: (.*)", said)[1].split(", "), {}
        pixels = [(int(x), int(y), list(map(float, v.split()))) for x, y, v in re.findall(r"Pixel \((\d+), (\d+)\): ([^\n]*)", said)]
        for name in names:
            if name.endswith(".R") or name == "R":
                layer = name[:-2] or "total"
                at = [names.index(name[:-1] + c) for c in "RGB"]
                layers[layer] = {(x, y): tuple(values[i] for i in at) for x, y, values in pixels}
        return layers

    def assert_digits(self, found, expected):
        for one, other in zip(found, expected):
            self.assertLessEqual(abs(one - other), 0.5001e-3 * abs(other) + 1e-7, f"{found}: {expected}")

    def test_a_click_tells_the_numbers_of_the_images(self):
        self.page = self.open("estimates")
        box, label = f"{ROOT}/scenes/cornell-box.xml", PAGES["estimates"][2]
        size = ("--resolution", "32x32")
        image = self.image("render", box, *size, "--method", f"{label} spp=4")
        for x, y in ((5, 16), (16, 30), (27, 12)):
            table = self.click_pixel(x, y)
            for name in ("direct", "indirect", "total"):
                self.assert_digits(table[name], image[name][x, y])
        self.assertIn("pixel (27, 12)", self.find("#estimate-words").text)

    def test_the_disc_reaches_to_the_kth_photon(self):
        self.page = self.open("estimates")
        self.click_pixel(7, 3)
        radius = float(re.search(r"disc to the 20th photon, radius ([\d.]+)", self.find("#estimate-words").text)[1])
        # The ceiling around the pixel is flat, and nothing hangs there within the disc: the photons near its plane count.
        columns = self.page.facts["estimate"]["grid"][0]
        place = self.page.array("pixel-points", "3f")[3 * columns + 7]
        away = sorted(sum((a - b) ** 2 for a, b in zip(p, place)) ** 0.5 for p in self.page.array("photon-positions", "3f")
                      if abs(p[1] - place[1]) < 1e-4)
        self.assertAlmostEqual(away[19] / radius, 1, delta=0.006)
        drawn = self.script("""
            const circle = arguments[0].layers.estimates.marks.children.at(-1).geometry;
            circle.computeBoundingSphere();
            return circle.boundingSphere.radius""", self.stage)
        self.assertAlmostEqual(drawn / radius, 1, delta=0.006)

    def test_a_black_lamp_is_not_called_specular(self):
        self.page = self.open("estimates")
        self.script("""
            const {estimates} = arguments[0].layers;
            estimates.show(estimates.reflections.findIndex((r, i) => r === 0 && estimates.points[3 * i] < Infinity))""", self.stage)
        self.assertIn("This surface reflects nothing: no photons", self.find("#estimate-words").text)

    def test_a_place_that_the_camera_does_not_see_has_no_estimate(self):
        self.page = self.open("estimates")
        self.script("arguments[0].focus()", self.stage)
        self.stage.send_keys("-" * 12)
        self.stage.send_keys(Keys.ARROW_LEFT * 20)
        self.settle()
        ActionChains(self.driver).move_to_element(self.stage).click().perform()
        self.assertIn("does not see", self.find("#estimate-words").text)
        self.assertEqual(self.find("#estimate-table").text, "")


class AreaTest(PhotonsCase):
    def test_records_are_discs_of_their_radius(self):
        page = self.open("box")
        count = page.facts["records"]
        self.assertGreater(count, 20)
        self.assertIn(f"{count:,} records", self.shown())
        found = self.script("""
            const records = arguments[0].layers.records, matrix = records.discs.matrix.clone(), all = [];
            for (let i = 0; i < records.discs.count; i++) {
              records.discs.getMatrixAt(i, matrix);
              all.push(matrix.elements.slice());
            }
            return all""", self.stage)
        self.assertEqual(len(found), count)
        radii, normals = page.array("record-radii", "f"), page.array("record-normals", "3f")
        for matrix, (radius,), normal in zip(found, radii, normals):
            axis = matrix[8:11]
            self.assertAlmostEqual(sum(v * v for v in axis) ** 0.5 / radius, 1, places=4)
            self.assertAlmostEqual(sum(a * n for a, n in zip(axis, normal)) / radius, 1, places=3)
        self.choose("Draw them", "hidden")
        self.check("global map")
        everything = self.drawn()
        self.assertGreater(everything, 1000)
        self.slide("Radius", -50)
        self.assertLess(self.drawn(), everything)
        self.check("discs of their radius")
        self.assertEqual(self.drawn(), 0)
        self.assertIn("no records", self.shown())

    def test_patches_have_corner_values(self):
        page = self.open("radiosity")
        self.assertIn(f"{page.facts['patches']:,} patches", self.shown())
        self.check("edges")
        lit = self.drawn()
        self.assertGreater(lit, 10000)
        ActionChains(self.driver).move_to_element(self.stage).click().perform()
        picked = self.find("#picked").text
        values = [tuple(float(v) for v in line.strip("()").split(", ")) for line in picked.split("\n")[1:]]
        self.assertIn(len(values), (3, 4))
        known = page.array("patch-radiosities", "3f")
        for value in values:
            self.assertTrue(any(all(abs(a - b) <= 0.006 * abs(b) + 1e-9 for a, b in zip(value, one)) for one in known))
        self.assertIn("pixel (", self.find("#estimate-words").text)
        size = self.stage.size
        ActionChains(self.driver).move_to_element_with_offset(self.stage, 3 - size["width"] // 2, 3 - size["height"] // 2).click().perform()
        self.assertFalse(self.find("#picked").is_displayed(), "nothing lies there")
        self.check("radiosity")
        self.assertEqual(self.drawn(), 0)

    def test_surfaces(self):
        self.open("glass")
        self.check("global map")
        self.check("caustic map")
        drawn = {}
        for how in ("translucent", "solid", "wire", "hidden"):
            self.choose("Draw them", how)
            drawn[how] = self.drawn()
        self.assertEqual(drawn["hidden"], 0)
        self.assertGreater(drawn["solid"], 100000)
        self.assertLess(drawn["wire"], drawn["solid"])
        self.choose("Draw them", "solid")
        self.control("Cut away").send_keys(Keys.END)
        self.settle()
        self.assertLess(self.drawn(), 0.5 * drawn["solid"])


if __name__ == "__main__":
    browser_case.main()
