#pragma once
// The report's page, style and scripts (report_page/) and Debian's Chart.js (libjs-chart.js), embedded by the build.

#include <string>
#include <string_view>

namespace gib {

/// The templates of the page, of a section in it and of table.md; report.cpp makes their data.
std::string_view report_page();
std::string_view report_section();
std::string_view table_page();
/// The CSS of the page.
std::string_view report_style();
/// The template of a tuning's page; tuning_page.cpp makes its data.
std::string_view tuning_page();
/// A script of report_page/ by its name; "chart.js" is Chart.js with its licence.
std::string_view page_script(std::string_view name);

}  // namespace gib
