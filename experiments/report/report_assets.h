#pragma once
// The report's page, style and scripts (report_page/) and Debian's Chart.js (libjs-chart.js), embedded by the build.

#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// The templates of the page, of a section in it and of table.md; report.cpp makes their data.
std::string_view report_page();
std::string_view report_section();
std::string_view table_page();
/// The CSS of the page.
std::string_view report_style();
/// The JavaScript of the page, in the order in which it has to run; the first is Chart.js with its licence.
std::vector<std::string_view> report_scripts();

}  // namespace gib
