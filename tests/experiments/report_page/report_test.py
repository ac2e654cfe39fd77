"""Clicks through report.html, that of a tuning too, in headless Chromium: report_test.py GIBENCH [options of unittest].

Screenshots go to the folder that the variable GIB_SCREENSHOTS names. Exit code 77: skipped.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

import browser_case  # noqa: E402  found by the line above

browser_case.require("oiiotool")

from report_page_cases import ChartTest, PageTest  # noqa: E402, F401  found by unittest
from report_strip_cases import StripTest  # noqa: E402, F401
from report_viewer_cases import ViewerTest  # noqa: E402, F401
from tune_page_cases import TunePageTest  # noqa: E402, F401

if __name__ == "__main__":
    browser_case.main()
