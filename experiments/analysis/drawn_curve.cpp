#include "experiments/analysis/drawn_curve.h"

#include "experiments/metrics/student_t.h"

#include <cmath>
#include <limits>
#include <map>

namespace gib {

namespace {

/// The checkpoints of the seeds after the same number of passes.
struct Pass {
    double seconds = 0;                      // summed over the seeds
    std::vector<double> relative, absolute;  // squared errors
};

Estimate root_of_mean(const std::vector<double>& squares) {
    const SampleMean mean = sample_mean(squares);
    // Below the noise floor, an error less the reference's own variance may be negative.
    if (!(mean.value >= 0)) return {std::numeric_limits<double>::quiet_NaN(), std::nullopt};
    Estimate root{std::sqrt(mean.value), std::nullopt};
    if (squares.size() < 2 || mean.value == 0) return root;
    // The logarithm of a root is half of that of its square, and so is the width of its interval.
    const double half = half_width({mean.variance}, 0.05) / mean.value / 2;
    root.interval = Interval{root.value * std::exp(-half), root.value * std::exp(half)};
    return root;
}

}  // namespace

std::vector<MeanPoint> mean_curve(const Analysis& analysis, const std::string& scene, const std::string& method,
                                  const std::string& component) {
    std::map<std::uint32_t, Pass> passes;
    std::size_t seeds = 0;
    for (const Cell& cell : analysis.cells) {
        if (cell.scene != scene || cell.method != method) continue;
        ++seeds;
        for (const auto& [checkpoint, errors] : cell.checkpoints) {
            const auto error = errors.find(component);
            if (error == errors.end()) continue;
            Pass& pass = passes[checkpoint.passes];
            pass.seconds += checkpoint.seconds;
            pass.relative.push_back(error->second.rel_mse_corrected);
            pass.absolute.push_back(error->second.mse_corrected);
        }
    }
    const double noise_floor = std::sqrt(analysis.noise_floor(scene, component));
    std::vector<MeanPoint> curve;
    for (const auto& [number, pass] : passes) {
        if (pass.relative.size() != seeds) continue;
        const MeanPoint point{.passes = number,
                              .seconds = pass.seconds / static_cast<double>(seeds),
                              .relative_rmse = root_of_mean(pass.relative),
                              .rmse = root_of_mean(pass.absolute)};
        const auto drawn = [](double v) { return std::isfinite(v) && v > 0; };
        if (drawn(point.seconds) && drawn(point.relative_rmse.value) && point.relative_rmse.value > noise_floor &&
            drawn(point.rmse.value))
            curve.push_back(point);
    }
    return curve;
}

}  // namespace gib
