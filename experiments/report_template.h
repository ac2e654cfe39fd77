#pragma once
// The frame of report.html, embedded when the program is built.

#include <string_view>

namespace gib {

/// HTML with {{TITLE}}, {{SUMMARY}} and {{SCENES}}.
std::string_view report_template();

}  // namespace gib
