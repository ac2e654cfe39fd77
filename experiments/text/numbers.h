#pragma once
// Formats numbers for the tables, the report and the messages. NaN becomes "nan": it must not be hidden, and a build
// that traps floating-point exceptions could not format it otherwise.

#include "experiments/metrics/statistics.h"

#include <string>

namespace gib {

/// Nine significant digits, for files.
std::string csv_number(double value);
/// Three significant digits: "12.3", "0.0123", "1.23e+04".
std::string short_number(double value);
/// A share in percent, "4.56".
std::string percent_text(double share);
/// A value with its interval, "12.3 (11.0 to 14.1)".
std::string with_interval(const Estimate& estimate, std::string (*text)(double) = short_number);

/// Replaces negative estimates of quantities that cannot be negative by 0, as texts show them; NaN stays NaN.
double at_least_zero(double value);

}  // namespace gib
