#pragma once
// Numbers as the tables, the report and the messages show them. All say "nan" where there is no number, because it must
// not be hidden; a build that traps floating-point exceptions could not even format it otherwise.

#include <string>

namespace gib {

/// Nine significant digits, for files.
std::string csv_number(double value);
/// Three significant digits: "12.3", "0.0123", "1.23e+04".
std::string short_number(double value);
/// A share in percent, "4.56".
std::string percent_text(double share);

/// 0 for negative estimates of what cannot be negative, as prose shows them; NaN stays.
double at_least_zero(double value);

}  // namespace gib
