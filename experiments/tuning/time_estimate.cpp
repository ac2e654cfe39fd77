#include "experiments/tuning/time_estimate.h"

#include "common/core/math.h"
#include "experiments/metrics/price_law.h"
#include "experiments/metrics/time_to_error.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// The curve over time, or over passes.
std::vector<CurvePoint> curve_of(const Cell& cell, bool over_passes = false) {
    std::vector<CurvePoint> curve;
    for (const auto& [checkpoint, errors] : cell.checkpoints)
        if (const auto total = errors.find(Layer::total); total != errors.end())
            curve.push_back({over_passes ? static_cast<double>(checkpoint.passes) : checkpoint.seconds,
                             std::sqrt(std::max(total->second.rel_mse_corrected, 0.0))});
    return curve;
}

/// The law of a run that has not reached the target.
ErrorLaw law_of(const Cell& cell, const std::vector<CurvePoint>& curve) {
    const CurvePoint& last = curve.back();
    if (cell.converged) return {.floor = sqr(last.error)};
    const double start = cell.prepare_seconds;
    std::vector<ErrorPoint> points;
    for (const CurvePoint& point : curve)
        points.push_back({point.seconds, sqr(point.error)});
    if (const auto price = fit_price_law({points}, start)) return price->law;
    return {.factor = sqr(last.error) * (last.seconds - start), .start = start};
}

}  // namespace

TimeEstimate estimated_time(const Cell& cell, double target, double horizon) {
    const auto curve = curve_of(cell);
    if (curve.empty()) return {};
    if (const auto time = time_to_error({curve}, target)) return {time->value, true};
    const ErrorLaw law = law_of(cell, curve);
    TimeEstimate estimate{law.seconds_to(sqr(target)).value_or(std::numeric_limits<double>::infinity())};
    const double latest = std::max(horizon, curve.back().seconds);
    if (estimate.seconds > latest && std::isfinite(latest)) estimate.beyond = latest * law.error2(latest) / sqr(target);
    return estimate;
}

std::vector<double> log_times(const std::vector<Cell>& cells, double target) {
    std::vector<double> times;
    for (const Cell& cell : cells) {
        const auto time = time_to_error({curve_of(cell)}, target);
        if (!time) return {};
        times.push_back(std::log(time->value));
    }
    return times;
}

std::optional<std::uint32_t> passes_to(const std::vector<Cell>& cells, double target) {
    std::vector<std::vector<CurvePoint>> curves;
    for (const Cell& cell : cells)
        curves.push_back(curve_of(cell, true));
    const auto passes = time_to_error(curves, target);
    if (!passes) return std::nullopt;
    return static_cast<std::uint32_t>(std::ceil(passes->value - 1e-9));
}

}  // namespace gib
