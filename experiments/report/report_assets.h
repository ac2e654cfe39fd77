#pragma once
// The report's page, style and scripts (report/), and Chart.js of Debian's libjs-chart.js: embedded by the build.

#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// HTML with {{TITLE}}, {{STYLE}}, {{SUMMARY}}, {{OVERVIEW}}, {{SCENES}}, {{DATA}}, {{PICTURES}} and {{SCRIPTS}}.
std::string_view report_page();
/// CSS.
std::string_view report_style();
/// JavaScript, in the order in which it has to run; the first is Chart.js with its licence.
std::vector<std::string_view> report_scripts();

}  // namespace gib
