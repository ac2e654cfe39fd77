#include "experiments/tuning/time_estimate.h"

#include "common/core/math.h"
#include "experiments/metrics/price_law.h"
#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace gib {

namespace {

constexpr double widest_interval = 30;  // ratio of the ends of an interval that is printed

/// The curve over time, or over passes.
std::vector<CurvePoint> curve_of(const Cell& cell, bool over_passes = false) {
    std::vector<CurvePoint> curve;
    for (const auto& [checkpoint, errors] : cell.checkpoints)
        if (const auto total = errors.find(Layer::total); total != errors.end())
            curve.push_back({over_passes ? static_cast<double>(checkpoint.passes) : checkpoint.seconds,
                             std::sqrt(std::max(total->second.rel_mse_corrected, 0.0))});
    return curve;
}

std::vector<ErrorPoint> squared(const std::vector<CurvePoint>& curve) {
    std::vector<ErrorPoint> points;
    for (const CurvePoint& point : curve)
        points.push_back({point.seconds, sqr(point.error)});
    return points;
}

/// The law of independent samples through the last point of a run.
ErrorLaw law_through_end(const Cell& cell, const CurvePoint& last) {
    return {.factor = sqr(last.error) * (last.seconds - cell.prepare_seconds), .start = cell.prepare_seconds};
}

/// The law of a run that has not reached the target.
ErrorLaw law_of(const Cell& cell, const std::vector<CurvePoint>& curve) {
    if (cell.converged) return {.floor = sqr(curve.back().error)};
    const auto price = fit_price_law({squared(curve)}, cell.prepare_seconds);
    return price ? price->law : law_through_end(cell, curve.back());
}

Estimate with_interval_of(const std::vector<double>& values) {
    const SampleMean mean = sample_mean(values);
    if (values.size() < 2) return {mean.value, std::nullopt};
    const double half = half_width({mean.variance}, interval_tail);
    return {mean.value, Interval{mean.value - half, mean.value + half}};
}

Estimate mapped(const Estimate& e, double (*to)(double)) {
    return {to(e.value), e.interval ? std::optional(Interval{to(e.interval->lo), to(e.interval->hi)}) : std::nullopt};
}

double mean_over(const std::vector<Cell>& cells, const std::function<double(const Cell&)>& value) {
    double sum = 0;
    for (const Cell& cell : cells)
        sum += value(cell);
    return sum / static_cast<double>(cells.size());
}

/// The runs of an unbiased method that have not all reached the target: each one's time by its law without a floor.
Estimate time_without_floor(const std::vector<Cell>& cells, double target) {
    std::vector<double> logs;
    for (const Cell& cell : cells) {
        const auto curve = curve_of(cell);
        const auto price = fit_price_law({squared(curve)}, cell.prepare_seconds);
        const auto crossing = time_to_error({curve}, target);
        const ErrorLaw law = price ? price->floorless : law_through_end(cell, curve.back());
        logs.push_back(std::log(crossing ? crossing->value : law.seconds_to(sqr(target)).value_or(infinity)));
    }
    return mapped(with_interval_of(logs), std::exp);
}

/// The same for a method that may have a floor: from the time without one to that with the highest floor that the runs allow.
Estimate time_above_floor(const std::vector<Cell>& cells, const std::optional<PriceLaw>& price, double target) {
    const double without = time_without_floor(cells, target).value;
    if (!price) return {without, Interval{without, infinity}};
    const double least = std::min(without, price->floorless.seconds_to(sqr(target)).value_or(without));
    ErrorLaw worst = price->law;
    worst.floor = price->floor.interval ? price->floor.interval->hi : infinity;
    const double most = worst.seconds_to(sqr(target)).value_or(infinity);
    const double likely = price->law.seconds_to(sqr(target)).value_or(least);
    return {likely, Interval{std::min(least, likely), std::max(most, likely)}};
}

/// The interval of an extrapolated time. It begins after the longest run that has not reached the target. One run tells no upper
/// end, nor does an interval that is too wide to say anything.
Interval told_interval(const Estimate& seconds, const std::vector<Cell>& cells, double target) {
    double lo = seconds.interval ? seconds.interval->lo : 0, hi = seconds.interval ? seconds.interval->hi : infinity;
    for (const Cell& cell : cells)
        if (curve_of(cell).back().error > target) lo = std::max(lo, std::min(cell.last().seconds, seconds.value));
    return {lo, hi > widest_interval * lo ? infinity : std::max(hi, lo)};
}

/// The passes of a run after so many seconds at the pace of its last image.
std::uint32_t passes_after(const std::vector<Cell>& cells, double seconds) {
    const double passes = mean_over(cells, [&](const Cell& cell) {
        const double pace = cell.last().passes / std::max(cell.last().seconds - cell.prepare_seconds, 1e-9);
        return pace * (seconds - cell.prepare_seconds);
    });
    return static_cast<std::uint32_t>(std::ceil(std::clamp(passes, 1.0, 1e9) - 1e-9));
}

}  // namespace

TimeEstimate estimated_time(const Cell& cell, double target, double horizon) {
    const auto curve = curve_of(cell);
    if (curve.empty()) return {};
    if (const auto time = time_to_error({curve}, target)) return {time->value, true};
    const ErrorLaw law = law_of(cell, curve);
    TimeEstimate estimate{law.seconds_to(sqr(target)).value_or(infinity)};
    const double latest = std::max(horizon, curve.back().seconds);
    if (estimate.seconds > latest && std::isfinite(latest)) estimate.beyond = latest * law.error2(latest) / sqr(target);
    return estimate;
}

Verdict verdict_of(const std::vector<Cell>& cells, double target, bool is_unbiased) {
    std::vector<std::vector<CurvePoint>> curves, over_passes;
    std::vector<std::vector<ErrorPoint>> points;
    std::vector<double> errors;
    for (const Cell& cell : cells) {
        curves.push_back(curve_of(cell));
        if (curves.back().empty()) return {};
        over_passes.push_back(curve_of(cell, true));
        points.push_back(squared(curves.back()));
        errors.push_back(curves.back().back().error);
    }
    Verdict verdict{.runs = cells.size()};
    if (cells.empty()) return verdict;
    verdict.error = mean_over(cells, [&](const Cell& cell) { return curve_of(cell).back().error; });
    verdict.seconds_of_error = mean_over(cells, [](const Cell& cell) { return cell.last().seconds; });
    if (const auto time = time_to_error(curves, target)) {
        verdict.state = Verdict::measured;
        verdict.seconds = *time;
        verdict.passes = static_cast<std::uint32_t>(std::ceil(time_to_error(over_passes, target)->value - 1e-9));
        for (const auto& curve : curves)
            verdict.log_times.push_back(std::log(time_to_error({curve}, target)->value));
        return verdict;
    }
    verdict.passes = passes_after(cells, verdict.seconds_of_error);
    const bool converged =
        verdict.error > target && std::ranges::all_of(cells, [](const Cell& cell) { return cell.converged; });
    const auto price = fit_price_law(points, mean_over(cells, [](const Cell& cell) { return cell.prepare_seconds; }));
    const bool has_floor = !is_unbiased && price && price->floor.interval && price->floor.interval->lo > sqr(target);
    if (converged || has_floor) {
        verdict.state = Verdict::not_reachable;
        verdict.floor = converged ? with_interval_of(errors) : mapped(price->floor, std::sqrt);
        return verdict;
    }
    verdict.state = Verdict::extrapolated;
    verdict.seconds = is_unbiased ? time_without_floor(cells, target) : time_above_floor(cells, price, target);
    verdict.seconds.interval = told_interval(verdict.seconds, cells, target);
    verdict.passes = passes_after(cells, verdict.seconds.value);
    return verdict;
}

}  // namespace gib
