#include "experiments/tuning/time_estimate.h"

#include "common/core/math.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

constexpr double widest_interval = 30;        // ratio of the ends of an interval that is printed
constexpr double farthest_beyond_runs = 100;  // times the longest run

std::vector<CurvePoint> curve_of(const Cell& cell) { return error_curves({&cell}, Layer::total).front(); }

/// The law of independent samples through the last point of a run.
ErrorLaw law_through_end(const Cell& cell, const CurvePoint& last) {
    return {.factor = sqr(last.error) * (last.seconds - cell.prepare_seconds), .start = cell.prepare_seconds};
}

/// The law of a run that has not reached the target.
ErrorLaw law_of(const Cell& cell, const std::vector<CurvePoint>& curve) {
    if (cell.converged) return {.floor = sqr(curve.back().error)};
    const auto price = price_law_of({&cell}, Layer::total, 0);
    return price ? price->law : law_through_end(cell, curve.back());
}

/// The mean of the values with its 95 % interval.
Estimate mean_of(const std::vector<double>& values) {
    const SampleMean mean = sample_mean(values);
    return estimate(mean.value, {mean.variance});
}

Estimate mapped(const Estimate& e, double (*to)(double)) {
    return {to(e.value), e.interval ? std::optional(Interval{to(e.interval->lo), to(e.interval->hi)}) : std::nullopt};
}

/// The floor of a law. The law's interval ends at the last error, which has an interval of its own.
Estimate floor_of(const PriceLaw& price, const Estimate& last_error) {
    Estimate floor = mapped(price.floor, std::sqrt);
    if (floor.interval && last_error.interval && floor.interval->hi >= 0.999 * last_error.value)
        floor.interval->hi = std::max(floor.interval->hi, last_error.interval->hi);
    return floor;
}

/// The time of independent samples: the mean over the runs of the measured time, or of the time by the law through the
/// last point.
Estimate time_of_independent_samples(const std::vector<Cell>& cells, double target) {
    std::vector<double> logs;
    for (const Cell& cell : cells) {
        const auto curve = curve_of(cell);
        const auto time = crossing_time(curve, target);
        logs.push_back(
            std::log(time ? *time : law_through_end(cell, curve.back()).seconds_to(sqr(target)).value_or(infinity)));
    }
    return mapped(mean_of(logs), std::exp);
}

/// An extrapolated time beyond every run that has not reached the target. It has no upper end if the law gives less
/// than such a run, for one run, for a very wide interval, and for a time far beyond the runs.
Estimate beyond_runs(const Estimate& seconds, const std::vector<Cell>& cells, double target) {
    double longest = 0;
    for (const Cell& cell : cells)
        if (!(curve_of(cell).back().error <= target)) longest = std::max(longest, cell.last().seconds);
    const double farthest = farthest_beyond_runs * longest;
    const double lo = std::clamp(seconds.interval ? seconds.interval->lo : 0, longest, farthest);
    if (!(seconds.value > longest)) return {longest, Interval{longest, infinity}};
    if (seconds.value > farthest) return {lo, Interval{lo, infinity}};
    const double hi = seconds.interval ? seconds.interval->hi : infinity;
    return {seconds.value, Interval{lo, hi > widest_interval * lo ? infinity : std::max(hi, lo)}};
}

/// The passes of a run after so many seconds at the pace of its last image.
std::uint32_t passes_after(const std::vector<Cell>& cells, double seconds) {
    double passes = 0;
    for (const Cell& cell : cells) {
        const double pace = cell.last().passes / std::max(cell.last().seconds - cell.prepare_seconds, 1e-9);
        passes += pace * (seconds - cell.prepare_seconds) / static_cast<double>(cells.size());
    }
    return static_cast<std::uint32_t>(std::ceil(std::clamp(passes, 1.0, 1e9) - 1e-9));
}

}  // namespace

TimeEstimate estimated_time(const Cell& cell, double target, double horizon) {
    const auto curve = curve_of(cell);
    if (curve.empty()) return {};
    if (const auto time = crossing_time(curve, target)) return {*time, true};
    const ErrorLaw law = law_of(cell, curve);
    TimeEstimate estimate{law.seconds_to(sqr(target)).value_or(infinity)};
    const double latest = std::max(horizon, curve.back().seconds);
    if (estimate.seconds > latest && std::isfinite(latest)) estimate.beyond = latest * law.error2(latest) / sqr(target);
    return estimate;
}

Verdict verdict_of(const std::vector<Cell>& cells, double target, bool is_unbiased) {
    Runs runs;
    for (const Cell& cell : cells)
        runs.push_back(&cell);
    const auto curves = error_curves(runs, Layer::total);
    if (curves.empty() || std::ranges::any_of(curves, [](const auto& curve) { return curve.empty(); })) return {};
    Verdict verdict{.runs = cells.size(), .seconds_of_error = mean_seconds(runs)};
    std::vector<double> errors;
    for (const auto& curve : curves)
        errors.push_back(curve.back().error);
    verdict.error = sample_mean(errors).value;
    verdict.reached = static_cast<std::size_t>(
        std::ranges::count_if(curves, [&](const auto& curve) { return crossing_time(curve, target).has_value(); }));
    if (const auto time = time_to_error(curves, target)) {
        verdict.state = Verdict::measured;
        verdict.seconds = *time;
        auto over_passes = curves;
        for (std::size_t run = 0; run < cells.size(); ++run) {
            verdict.log_times.push_back(std::log(crossing_time(curves[run], target).value()));
            for (std::size_t i = 0; i < curves[run].size(); ++i)
                over_passes[run][i].seconds = cells[run].checkpoints[i].checkpoint.passes;
        }
        verdict.passes = static_cast<std::uint32_t>(std::ceil(time_to_error(over_passes, target)->value - 1e-9));
        return verdict;
    }
    verdict.passes = passes_after(cells, verdict.seconds_of_error);
    const bool converged = verdict.error > target && have_converged(runs);
    const auto price = price_law_of(runs, Layer::total, 0);
    const auto time = price ? price->extrapolate(sqr(target), is_unbiased) : std::nullopt;
    if (converged || (time && time->kind == Extrapolation::Kind::never)) {
        verdict.state = Verdict::not_reachable;
        verdict.floor = converged ? mean_of(errors) : floor_of(*price, mean_of(errors));
        return verdict;
    }
    verdict.state = Verdict::extrapolated;
    Estimate seconds{0, std::nullopt};
    // Theory knows the law of runs that are too few or too short to show it. Those that have reached the target know
    // their own times.
    if (is_unbiased && (verdict.reached > 0 || !(price && price->floor.interval)))
        seconds = time_of_independent_samples(cells, target);
    else if (time && law_reaches(*price, price->last_seconds))
        seconds = {time->seconds, time->interval.value_or(Interval{time->seconds, infinity})};
    verdict.seconds = beyond_runs(seconds, cells, target);
    verdict.passes = passes_after(cells, verdict.seconds.value);
    return verdict;
}

}  // namespace gib
