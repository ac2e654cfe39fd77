"""Pages of gibench in headless Chromium: what their tests share. Importing this without the packages ends with code 77."""
import importlib.util
import os
import shutil
import sys
import tempfile
import unittest


def require(*programs):
    """Ends the process with the code of a skipped test if a program or selenium is missing."""
    missing = [name for name in programs if not shutil.which(name)]
    if not importlib.util.find_spec("selenium"):
        missing.append("python3-selenium")
    if missing:
        print(f"skipped: not installed: {', '.join(missing)} (./scripts/setup scripts/packages-report.txt installs them)")
        sys.exit(77)


require("chromium", "chromedriver")

from selenium import webdriver  # noqa: E402
from selenium.webdriver.chrome.service import Service  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
LAPTOP, PHONE = (1366, 768), (390, 844)


class BrowserCase(unittest.TestCase):
    """Tests of one browser."""
    program = None  # gibench
    screenshots = ""  # a folder; empty: they are made and thrown away
    graphics = ("--disable-gpu",)  # options of Chromium
    logs = ("browser",)
    phone = PHONE

    @classmethod
    def setUpClass(cls):
        cls.parent = tempfile.TemporaryDirectory()
        cls.shots = cls.screenshots or cls.parent.name
        os.makedirs(cls.shots, exist_ok=True)
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for argument in ("--headless=new", "--no-sandbox", "--hide-scrollbars", "--force-color-profile=srgb",
                         "--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=1366,768",
                         *cls.graphics):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {log: "ALL" for log in cls.logs})
        cls.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)

    @classmethod
    def tearDownClass(cls):
        cls.driver.quit()
        cls.parent.cleanup()

    def tearDown(self):
        # The log has an entry for anything that is missing, that is blocked, or that throws. WebGL's own notes about
        # speed are no errors of the page.
        self.assertEqual([entry for entry in self.driver.get_log("browser")
                          if entry["level"] != "INFO" and "GPU stall" not in entry["message"]], [])

    def load(self, file, size, scheme="light"):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size == self.phone})
        self.set_scheme(scheme)
        self.driver.get("file://" + file)

    def set_scheme(self, scheme):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def text_without_scripts(self, file):
        """The text of a page where scripts are not executed."""
        self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        try:
            self.driver.get("file://" + file)
            return self.driver.find_element(By.TAG_NAME, "body").text
        finally:
            self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})

    def script(self, code, *arguments):
        return self.driver.execute_script(code, *arguments)

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def shot(self, name):
        self.driver.save_screenshot(os.path.join(self.shots, name + ".png"))

    def assert_fits(self, name):
        wide = self.script("return document.documentElement.scrollWidth - innerWidth")
        self.assertLessEqual(wide, 0, f"{name}: the page is wider than the screen")


def main():
    """Runs the tests of the calling file: FILE GIBENCH [options of unittest]."""
    BrowserCase.program = os.path.abspath(sys.argv[1])
    BrowserCase.screenshots = os.environ.get("GIB_SCREENSHOTS", "")
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:])
