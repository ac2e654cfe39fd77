#include "experiments/metrics/time_to_error.h"

#include "common/core/math.h"
#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

namespace {

/// The logarithm of the time [s] from which on a curve is at or below the target; NaN if it ends above.
double log_crossing(const std::vector<CurvePoint>& curve, double target) {
    std::size_t i = curve.size();  // the first point from which on all are
    while (i > 0 && curve[i - 1].error <= target)
        --i;
    if (i == curve.size()) return std::numeric_limits<double>::quiet_NaN();
    const CurvePoint& b = curve[i];
    // Without an earlier point to interpolate from, this checkpoint is the first time that is known to be enough.
    if (i == 0 || !std::isfinite(curve[i - 1].error) || !(b.error > 0) || !(curve[i - 1].seconds > 0))
        return std::log(b.seconds);
    const CurvePoint& a = curve[i - 1];
    const double part = std::log(a.error / target) / std::log(a.error / b.error);
    return std::log(a.seconds) + part * std::log(b.seconds / a.seconds);
}

/// By how much the end of an interval of mean +- half has to move because the values are skewed (Johnson 1978,
/// "Modified t tests and confidence intervals for asymmetrical populations"): with n values of variance s^2 and third
/// central moment m3, m3 / (6 s^2 n) + m3 half^2 / (3 s^4). Only the end that moves outwards is moved, because few
/// values show little of their skewness.
double skewness_shift(const std::vector<double>& values, double mean, double half) {
    const auto n = static_cast<double>(values.size());
    double squares = 0, cubes = 0;
    for (const double value : values) {
        squares += sqr(value - mean);
        cubes += sqr(value - mean) * (value - mean);
    }
    const double variance = squares / (n - 1), m3 = cubes / n;
    return variance > 0 ? m3 / (6 * variance * n) + m3 * sqr(half) / (3 * sqr(variance)) : 0;
}

}  // namespace

std::optional<double> crossing_time(const std::vector<CurvePoint>& curve, double target) {
    const double log_time = log_crossing(curve, target);
    return std::isnan(log_time) ? std::nullopt : std::optional(std::exp(log_time));
}

std::optional<Estimate> time_to_error(const std::vector<std::vector<CurvePoint>>& curves, double target) {
    std::vector<double> times;
    for (const auto& curve : curves) {
        times.push_back(log_crossing(curve, target));
        if (!std::isfinite(times.back())) return std::nullopt;
    }
    if (times.empty()) return std::nullopt;
    const auto [mean, variance] = sample_mean(times);
    if (times.size() < 2) return Estimate{std::exp(mean), std::nullopt};
    const double half = half_width({variance}, interval_tail);
    const double shift = skewness_shift(times, mean, half);
    return Estimate{std::exp(mean), Interval{std::exp(mean - half + std::min(shift, 0.0)),
                                             std::exp(mean + half + std::max(shift, 0.0))}};
}

}  // namespace gib
