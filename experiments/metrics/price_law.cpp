#include "experiments/metrics/price_law.h"

#include "common/core/math.h"
#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

namespace {

constexpr std::size_t least_points = 4;  // three unknowns, and one more point to test the fit
constexpr double least_slope = 0.1, largest_slope = 4;
constexpr double end_span = 4;  // factor of time, over which noise falls to half its error
/// A fitted floor below this share of the last squared error counts as none. Where there is no floor, rounding leaves
/// one of 2^-53 times the condition of the fit. This condition is 376 for four points over a fourfold time at the
/// least slope, and near 1e5 for points over which the law falls by no more than `least_fall`, so that rounding
/// leaves a share of 1e-11 at most. A floor of 1e-6 of the squared error is 0.1 % of the error.
constexpr double least_floor = 1e-6;
constexpr double least_fall = 0.01;  // share by which the squared error has to fall over the measured span
/// The probability that the truth lies beyond PriceLaw::ceiling or as far below, both sides together.
constexpr double ceiling_tail = 0.005;
/// A derivative of the residual this small, relative to the inverse of the last squared error, is rounding.
constexpr double least_derivative = 1e-5;
constexpr double widest_interval = 30;  // ratio of the ends of an interval that is printed

using Curve = std::vector<ErrorPoint>;

double largest_deviation(const ErrorLaw& law, const Curve& points) {
    double largest = 0;
    for (const ErrorPoint& p : points)
        largest = std::max(largest, std::abs(law.error2(p.seconds) / p.error2 - 1));
    return largest;
}

/// The mean of the runs without the run `left_out`. It ends before the first point that is not above the noise floor.
Curve mean_curve(const std::vector<Curve>& runs, std::size_t left_out, double noise_floor) {
    std::size_t count = runs.front().size();
    for (const Curve& run : runs)
        count = std::min(count, run.size());
    const auto n = static_cast<double>(runs.size() - (left_out < runs.size() ? 1 : 0));
    Curve mean;
    for (std::size_t i = 0; i < count; ++i) {
        ErrorPoint point{0, 0};
        for (std::size_t r = 0; r < runs.size(); ++r) {
            if (r == left_out) continue;
            point.seconds += runs[r][i].seconds / n;
            point.error2 += runs[r][i].error2 / n;
        }
        if (!std::isfinite(point.error2) || point.error2 <= noise_floor) break;
        mean.push_back(point);
    }
    return mean;
}

struct Fit {
    ErrorLaw law;
    double residual = 0;  ///< sum over the points of (law / error2 - 1)^2
};

/// The floor F and the factor c for a given slope. They minimise sum_i (1 - F a_i - c b_i)^2 with F >= 0 and c >= 0,
/// where a_i = 1 / e_i and b_i = u_i / e_i for the squared error e_i at the time t_i, and where u_i is (t_i -
/// start)^-slope. Times are divided by `unit` [s] so that the problem is well conditioned.
Fit fit_linear_part(const Curve& curve, double start, double slope, double unit, bool with_floor) {
    double a = 0, b = 0, aa = 0, ab = 0, bb = 0;
    for (const auto& p : curve) {
        const double ai = 1 / p.error2, bi = std::pow((p.seconds - start) / unit, -slope) / p.error2;
        a += ai, b += bi, aa += ai * ai, ab += ai * bi, bb += bi * bi;
    }
    const double determinant = aa * bb - ab * ab;
    double floor = determinant > 0 ? (a * bb - b * ab) / determinant : 0;
    double factor = determinant > 0 ? (b * aa - a * ab) / determinant : 0;
    if (!with_floor || !(floor > least_floor * curve.back().error2)) floor = 0, factor = b / bb;
    if (with_floor && !(factor > 0)) floor = a / aa, factor = 0;
    Fit fit{{.floor = floor, .factor = factor * std::pow(unit, slope), .slope = slope, .start = start}, 0};
    for (const auto& p : curve)
        fit.residual += sqr(fit.law.error2(p.seconds) / p.error2 - 1);
    return fit;
}

/// The logarithm of the slope with the least residual: a search over a grid of slopes, and then a golden-section search
/// around the best of them.
template <typename Residual>
double least_argument(const Residual& residual, int grid, int sections) {
    const double from = std::log(least_slope), step = std::log(largest_slope / least_slope) / grid;
    int best = 0;
    double least = residual(from);
    for (int i = 1; i <= grid; ++i)
        if (const double here = residual(from + i * step); here < least) least = here, best = i;
    double lo = from + std::max(best - 1, 0) * step, hi = from + std::min(best + 1, grid) * step;
    constexpr double golden = 0.6180339887498949;
    for (int i = 0; i < sections; ++i) {
        const double left = hi - golden * (hi - lo), right = lo + golden * (hi - lo);
        if (residual(left) < residual(right)) hi = right;
        else lo = left;
    }
    return (lo + hi) / 2;
}

/// The fit with the best slope.
std::optional<Fit> fit_law(const Curve& curve, double start, bool with_floor = true) {
    if (curve.size() < least_points || !(curve.front().seconds > start)) return std::nullopt;
    const double unit = std::sqrt((curve.front().seconds - start) * (curve.back().seconds - start));
    const auto at = [&](double log_slope) {
        return fit_linear_part(curve, start, std::exp(log_slope), unit, with_floor);
    };
    const Fit fit = at(least_argument([&](double log_slope) { return at(log_slope).residual; }, 64, 40));
    // If the law hardly falls over the measured span, its slope is not determined.
    const bool falls = fit.law.error2(curve.back().seconds) < (1 - least_fall) * fit.law.error2(curve.front().seconds);
    return falls ? std::optional(fit) : std::nullopt;
}

/// The law with the best slope and factor for a given floor.
ErrorLaw law_with_floor(const Curve& curve, double start, double floor) {
    const double unit = std::sqrt((curve.front().seconds - start) * (curve.back().seconds - start));
    std::vector<std::pair<double, double>> points;  // log((t - start) / unit), 1 / error2
    for (const auto& p : curve)
        points.emplace_back(std::log((p.seconds - start) / unit), 1 / p.error2);
    double factor = 0;
    const auto residual = [&](double log_slope) {
        const double slope = std::exp(log_slope);
        double ab = 0, bb = 0, aa = 0;  // sums over a = 1 - floor / e and b = u / e
        for (const auto& [log_time, inverse] : points) {
            const double bi = std::exp(-slope * log_time) * inverse, ai = 1 - floor * inverse;
            ab += ai * bi, bb += bi * bi, aa += ai * ai;
        }
        factor = std::max(ab / bb, 0.0);
        return aa - 2 * factor * ab + sqr(factor) * bb;
    };
    const double log_slope = least_argument(residual, 8, 36);
    residual(log_slope);
    const double slope = std::exp(log_slope);
    return {.floor = floor, .factor = factor * std::pow(unit, slope), .slope = slope, .start = start};
}

/// Half the derivative of the residual by the floor at a given one, times the last squared error: below 0 where a
/// higher floor fits better. The slope and the factor are at their best, so that their changes do not count.
double floor_derivative(const Curve& curve, double start, double floor) {
    const ErrorLaw law = law_with_floor(curve, start, floor);
    double sum = 0;
    for (const auto& p : curve)
        sum += (law.error2(p.seconds) / p.error2 - 1) * curve.back().error2 / p.error2;
    return sum;
}

/// A curve, and those without one run in turn.
struct Curves {
    Curve all;
    std::vector<Curve> without;
    double start;

    /// The interval of floor_derivative() at a floor; it misses the truth with probability `missed`.
    Interval derivative(double floor, double missed) const {
        std::vector<double> others;
        for (const Curve& curve : without)
            others.push_back(floor_derivative(curve, start, floor));
        return *jackknife(floor_derivative(all, start, floor), others, missed).interval;
    }
    /// The highest floor that the runs allow; the last squared error if even 0 is too high for them, because then the
    /// law does not describe them.
    double highest_floor(double missed) const {
        const double end = all.back().error2;
        const auto allows = [&](double floor) { return derivative(floor, missed).lo <= least_derivative; };
        return allows(0) ? last_allowed(0, end, allows) : end;
    }
    /// The lowest one, above 0 only if there is one that is too low.
    double lowest_floor(double highest, double missed) const {
        const auto is_too_low = [&](double floor) { return derivative(floor, missed).hi < -least_derivative; };
        return is_too_low(0) ? last_allowed(0, highest, is_too_low) : 0;
    }
    template <typename Allows>
    static double last_allowed(double lo, double hi, const Allows& allows) {
        for (int step = 0; step < 20; ++step) {
            const double middle = (lo + hi) / 2;
            (allows(middle) ? lo : hi) = middle;
        }
        return lo;
    }
};

/// The slope at which log(error2) falls with log(t - start) at the end of a curve: between its last point and the
/// latest point whose t - start is smaller by the factor `end_span` or more, or the first point if there is none.
double end_slope(const Curve& curve, double start) {
    const ErrorPoint& end = curve.back();
    std::size_t i = curve.size() - 1;
    while (i > 0 && (curve[i].seconds - start) * end_span > end.seconds - start)
        --i;
    return std::log(curve[i].error2 / end.error2) / std::log((end.seconds - start) / (curve[i].seconds - start));
}

/// Whether a slope is at an end of the range that was searched, so that the curve does not determine it.
bool is_at_end(const ErrorLaw& law) { return law.slope < 1.01 * least_slope || law.slope > 0.99 * largest_slope; }

/// The laws of all curves; empty if one of them has none.
std::vector<ErrorLaw> laws_of(const std::vector<Curve>& curves, double start, bool with_floor) {
    std::vector<ErrorLaw> laws;
    for (const Curve& curve : curves) {
        const auto fit = fit_law(curve, start, with_floor);
        if (!fit) return {};
        laws.push_back(fit->law);
    }
    return laws;
}

/// value(law) with the interval of the jackknife in its logarithm; empty if it is undefined for one of the laws.
template <typename Value>
std::optional<Estimate> log_estimate(const ErrorLaw& law, const std::vector<ErrorLaw>& without, const Value& value) {
    const std::optional<double> whole = value(law);
    std::vector<double> logs;
    for (const ErrorLaw& one : without)
        if (const std::optional<double> v = value(one); v && *v > 0) logs.push_back(std::log(*v));
    if (!whole || !(*whole > 0) || logs.size() < std::max<std::size_t>(without.size(), 2)) return std::nullopt;
    const Interval interval = *jackknife(std::log(*whole), logs).interval;
    return Estimate{*whole, Interval{std::exp(interval.lo), std::exp(interval.hi)}};
}

/// Adds the intervals by the scatter of the runs.
void add_intervals(PriceLaw& price, const Curves& curves) {
    price.without = laws_of(curves.without, curves.start, true);
    price.floorless_without = laws_of(curves.without, curves.start, false);
    if (price.without.empty() || price.floorless_without.empty()) return;
    std::vector<double> slopes, end_slopes, floorless_slopes;
    for (std::size_t r = 0; r < price.without.size(); ++r) {
        slopes.push_back(price.without[r].slope);
        end_slopes.push_back(end_slope(curves.without[r], curves.start));
        floorless_slopes.push_back(price.floorless_without[r].slope);
    }
    const double highest = std::max(curves.highest_floor(interval_tail), price.floor.value);
    const bool bends = jackknife(end_slope(curves.all, curves.start), end_slopes).interval->hi < 1;
    const double lowest = bends ? std::min(curves.lowest_floor(highest, interval_tail), price.floor.value) : 0;
    price.floor.interval = Interval{lowest, highest};
    price.ceiling =
        law_with_floor(curves.all, curves.start, std::max(curves.highest_floor(ceiling_tail), price.floor.value));
    if (!is_at_end(price.law) && std::ranges::none_of(price.without, is_at_end))
        price.slope = jackknife(price.law.slope, slopes);
    price.floorless_slope = jackknife(price.floorless.slope, floorless_slopes);
}

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

double ErrorLaw::error2(double seconds) const { return floor + factor * std::pow(seconds - start, -slope); }

std::optional<double> ErrorLaw::seconds_to(double target) const {
    if (!(target > floor) || !(factor > 0)) return std::nullopt;
    return start + std::pow(factor / (target - floor), 1 / slope);
}

ErrorLaw ErrorLaw::no_steeper_after(double seconds) const {
    if (slope <= 1) return *this;
    return {.floor = floor, .factor = (error2(seconds) - floor) * (seconds - start), .slope = 1, .start = start};
}

std::optional<Extrapolation> PriceLaw::extrapolate(double error2, bool has_no_floor) const {
    using Kind = Extrapolation::Kind;
    if (!floor.interval || !slope.interval) return std::nullopt;
    if (floor.interval->lo >= error2) return has_no_floor ? std::nullopt : std::optional(Extrapolation{Kind::never});
    const auto soonest = [error2](const ErrorLaw& one) { return one.seconds_to(error2); };
    const auto seconds_to = [&](const ErrorLaw& one) { return one.no_steeper_after(last_seconds).seconds_to(error2); };
    const auto least = log_estimate(floorless, floorless_without, soonest);
    if (!least) return std::nullopt;
    // An interval this wide says no more than its lower end.
    const auto told = [&](double seconds, const Interval& interval) {
        if (interval.hi < widest_interval * interval.lo) return Extrapolation{Kind::time, seconds, interval};
        return Extrapolation{Kind::at_least, least->interval->lo, std::nullopt};
    };
    const bool is_floorless = has_no_floor && !stands();
    const auto time =
        is_floorless ? log_estimate(floorless, floorless_without, seconds_to) : log_estimate(law, without, seconds_to);
    const auto latest = is_floorless && time ? std::optional(time->interval->hi) : seconds_to(ceiling);
    if (!time || !latest) return Extrapolation{Kind::at_least, least->interval->lo, std::nullopt};
    return told(time->value,
                {std::min(time->interval->lo, least->interval->lo), std::max(time->interval->hi, *latest)});
}

Estimate PriceLaw::error2_after(double seconds, bool theory_has_no_floor) const {
    const bool has_no_floor = theory_has_no_floor && !stands();
    const ErrorLaw& best = has_no_floor ? floorless : law;
    const auto& others = has_no_floor ? floorless_without : without;
    const auto after = [&](const ErrorLaw& one) {
        return std::optional(one.no_steeper_after(last_seconds).error2(seconds));
    };
    const auto e = log_estimate(best, others, after);
    const auto least =
        log_estimate(best, others, [&](const ErrorLaw& one) { return std::optional(one.error2(seconds)); });
    if (!e || !least || !slope.interval) return {*after(best), std::nullopt};
    if (has_no_floor) return {e->value, Interval{std::min(least->interval->lo, e->interval->lo), e->interval->hi}};
    const double lowest = std::min({least->interval->lo, e->interval->lo, floorless.error2(seconds)});
    return {e->value, Interval{std::max(lowest, floor.interval ? floor.interval->lo : 0),
                               std::max(e->interval->hi, *after(ceiling))}};
}

std::optional<PriceLaw> fit_price_law(const std::vector<std::vector<ErrorPoint>>& runs, double start,
                                      double noise_floor) {
    if (runs.empty()) return std::nullopt;
    Curves curves{.all = mean_curve(runs, runs.size(), noise_floor), .without = {}, .start = start};
    const auto fit = fit_law(curves.all, start), floorless = fit_law(curves.all, start, false);
    if (!fit) return std::nullopt;
    PriceLaw price;
    price.law = fit->law;
    price.floorless = floorless ? floorless->law : fit->law;
    price.ceiling = fit->law;
    price.floor = {fit->law.floor, std::nullopt};
    price.slope = {fit->law.slope, std::nullopt};
    price.last_seconds = curves.all.back().seconds;
    price.floorless_slope = {price.floorless.slope, std::nullopt};
    price.misfit = largest_deviation(price.law, curves.all);
    price.floorless_misfit = largest_deviation(price.floorless, curves.all);
    for (std::size_t r = 0; runs.size() > 2 && r < runs.size(); ++r)
        curves.without.push_back(mean_curve(runs, r, noise_floor));
    add_intervals(price, curves);
    return price;
}

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
