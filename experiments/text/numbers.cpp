#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <cmath>

namespace gib {

namespace {

template <typename Format>
std::string unless_nan(double value, const Format& format) {
    return std::isnan(value) ? "nan" : format(value);
}

std::string three_digits(double value) {
    const double size = std::abs(value);
    if (value != 0 && (size < 1e-3 || size >= 1e5)) return fmt::format("{:.2e}", value);
    const int decimals = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4;
    return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::string csv_number(double value) {
    return unless_nan(value, [](double x) { return fmt::format("{:.9g}", x); });
}

std::string short_number(double value) { return unless_nan(value, three_digits); }

std::string percent_text(double share) {
    return unless_nan(share, [](double x) { return fmt::format("{:.2f}", 100 * x); });
}

std::string with_interval(const Estimate& estimate, std::string (*text)(double)) {
    if (!estimate.interval) return text(estimate.value);
    return fmt::format("{} ({} to {})", text(estimate.value), text(estimate.interval->lo), text(estimate.interval->hi));
}

double at_least_zero(double value) { return std::isless(value, 0.0) ? 0.0 : value; }

}  // namespace gib
