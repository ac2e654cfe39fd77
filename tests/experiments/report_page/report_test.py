"""Clicks through report.html and tune.html in headless Chromium: report_test.py GIBENCH [options of unittest].

Screenshots go to the folder that the variable GIB_SCREENSHOTS names. Exit code 77: skipped.
"""
import importlib.util
import os
import shutil
import sys
import unittest

MISSING = [name for name in ("chromium", "chromedriver", "oiiotool") if not shutil.which(name)]
if not importlib.util.find_spec("selenium"):
    MISSING.append("python3-selenium")
if MISSING:
    print(f"skipped: not installed: {', '.join(MISSING)} (./scripts/setup scripts/packages-report.txt installs them)")
    sys.exit(77)

from report_browser import ReportCase  # noqa: E402  needs selenium
from report_page_cases import ChartTest, PageTest  # noqa: E402, F401  found by unittest
from report_strip_cases import StripTest  # noqa: E402, F401
from report_viewer_cases import ViewerTest  # noqa: E402, F401
from tune_page_cases import TunePageTest  # noqa: E402, F401

if __name__ == "__main__":
    ReportCase.program = os.path.abspath(sys.argv[1])
    ReportCase.screenshots = os.environ.get("GIB_SCREENSHOTS", "")
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:])
