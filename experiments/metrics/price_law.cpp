#include "experiments/metrics/price_law.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>

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

using Curve = std::vector<ErrorPoint>;

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

/// The fit whose slope has the smallest residual, by a search over a grid of slopes and then a golden-section search
/// around the best of them.
std::optional<Fit> fit_law(const Curve& curve, double start, bool with_floor = true) {
    if (curve.size() < least_points || !(curve.front().seconds > start)) return std::nullopt;
    const double unit = std::sqrt((curve.front().seconds - start) * (curve.back().seconds - start));
    const auto at = [&](double log_slope) {
        return fit_linear_part(curve, start, std::exp(log_slope), unit, with_floor);
    };
    constexpr int steps = 64;
    const double from = std::log(least_slope), step = std::log(largest_slope / least_slope) / steps;
    int best = 0;
    for (int i = 1; i <= steps; ++i)
        if (at(from + i * step).residual < at(from + best * step).residual) best = i;
    double lo = from + std::max(best - 1, 0) * step, hi = from + std::min(best + 1, steps) * step;
    constexpr double golden = 0.6180339887498949;
    for (int i = 0; i < 40; ++i) {
        const double left = hi - golden * (hi - lo), right = lo + golden * (hi - lo);
        (at(left).residual < at(right).residual ? hi : lo) = at(left).residual < at(right).residual ? right : left;
    }
    const Fit fit = at((lo + hi) / 2);
    // If the law hardly falls over the measured span, its slope is not determined.
    const bool falls = fit.law.error2(curve.back().seconds) < (1 - least_fall) * fit.law.error2(curve.front().seconds);
    return falls ? std::optional(fit) : std::nullopt;
}

/// The factor by which the charged time, preparation included, grows from `seconds` on for half the error.
std::optional<double> halving_factor(const ErrorLaw& law, double seconds) {
    const auto half = law.seconds_to(law.error2(seconds) / 4);
    return half ? std::optional(*half / seconds) : std::nullopt;
}

/// The slope at which log(error2) falls with log(t - start) at the end of a curve: between its last point and the
/// latest point whose t - start is smaller by the factor `end_span` or more, or the first point if there is none.
double end_slope(const Curve& curve, double start) {
    const ErrorPoint& end = curve.back();
    std::size_t i = curve.size() - 1;
    while (i > 0 && (curve[i].seconds - start) * end_span > end.seconds - start)
        --i;
    return std::log(curve[i].error2 / end.error2) / std::log((end.seconds - start) / (curve[i].seconds - start));
}

/// The floors, slopes and logarithms of halving factors of the fits that leave out one run in turn. A list is empty
/// if one of the fits lacks its value.
struct WithoutOne {
    std::vector<double> floors, slopes, end_slopes, log_halvings;
};

WithoutOne fits_without_one(const std::vector<Curve>& runs, double start, double noise_floor) {
    WithoutOne result;
    if (runs.size() < 3) return result;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const Curve curve = mean_curve(runs, r, noise_floor);
        const auto fit = fit_law(curve, start);
        if (!fit) return {};
        result.floors.push_back(fit->law.floor);
        result.slopes.push_back(fit->law.slope);
        result.end_slopes.push_back(end_slope(curve, start));
        if (const auto halving = halving_factor(fit->law, curve.back().seconds))
            result.log_halvings.push_back(std::log(*halving));
    }
    if (result.log_halvings.size() < runs.size()) result.log_halvings.clear();
    return result;
}

/// Removes the next halving if only a lower bound of it is known.
PriceLaw with_known_halving(PriceLaw price) {
    const auto time = price.extrapolate(price.law.error2(price.last_seconds) / 4);
    if (!time || time->at_least) price.next_halving.reset();
    return price;
}

}  // namespace

double ErrorLaw::error2(double seconds) const { return floor + factor * std::pow(seconds - start, -slope); }

std::optional<double> ErrorLaw::seconds_to(double target) const {
    if (!(target > floor) || !(factor > 0)) return std::nullopt;
    return start + std::pow(factor / (target - floor), 1 / slope);
}

std::optional<PriceLaw::Extrapolation> PriceLaw::extrapolate(double error2) const {
    const double certain = floor.interval ? floor.interval->lo : 0;
    if (law.floor == 0 || certain > 0)
        if (const auto seconds = law.seconds_to(error2)) return Extrapolation{*seconds, false};
    if (certain >= error2) return std::nullopt;
    const auto least = floorless.seconds_to(error2);
    return least ? std::optional(Extrapolation{*least, true}) : std::nullopt;
}

std::optional<PriceLaw> fit_price_law(const std::vector<std::vector<ErrorPoint>>& runs, double start,
                                      double noise_floor) {
    if (runs.empty()) return std::nullopt;
    const Curve curve = mean_curve(runs, runs.size(), noise_floor);
    const auto fit = fit_law(curve, start);
    if (!fit) return std::nullopt;
    const ErrorLaw& law = fit->law;
    PriceLaw price;
    price.law = law;
    const auto floorless = fit_law(curve, start, false);
    price.floorless = floorless ? floorless->law : law;
    price.floor = {law.floor, std::nullopt};
    price.slope = {law.slope, std::nullopt};
    price.first_seconds = curve.front().seconds;
    price.last_seconds = curve.back().seconds;
    for (const auto& p : curve)
        price.misfit = std::max(price.misfit, std::abs(law.error2(p.seconds) / p.error2 - 1));
    if (const auto halving = halving_factor(law, price.last_seconds)) price.next_halving = {*halving, std::nullopt};

    const WithoutOne without = fits_without_one(runs, start, noise_floor);
    if (without.slopes.empty()) return with_known_halving(price);
    price.floor = jackknife(law.floor, without.floors);
    const bool bends = jackknife(end_slope(curve, start), without.end_slopes).interval->hi < 1;
    price.floor.interval->lo = bends ? std::max(0.0, price.floor.interval->lo) : 0;
    price.slope = jackknife(law.slope, without.slopes);
    if (price.next_halving && !without.log_halvings.empty()) {
        const Estimate log_halving = jackknife(std::log(price.next_halving->value), without.log_halvings);
        price.next_halving->interval = {std::exp(log_halving.interval->lo), std::exp(log_halving.interval->hi)};
    }
    return with_known_halving(price);
}

}  // namespace gib
