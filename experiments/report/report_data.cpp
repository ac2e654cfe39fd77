#include "experiments/report/report_data.h"

#include "experiments/analysis/curves.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/metrics/student_t.h"

#include <cmath>
#include <limits>
#include <map>

namespace gib {

using nlohmann::json;

namespace {

struct MeanPoint {
    std::uint32_t passes;
    double seconds;  ///< mean over the seeds
    /// Square roots of the seeds' mean squared errors, less the reference's own variance. Their 95 % intervals come
    /// from Student's t over the scatter of the seeds alone and are symmetric in the logarithm; one seed has none.
    Estimate relative_rmse, rmse;
};

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

/// The points of the curve that logarithmic axes can show, with times and errors above 0, and whose error is above
/// the noise floor.
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

void append(json& numbers, const Estimate& e) {
    numbers.push_back(number_to_json(e.value));
    numbers.push_back(e.interval ? number_to_json(e.interval->lo) : json(nullptr));
    numbers.push_back(e.interval ? number_to_json(e.interval->hi) : json(nullptr));
}

/// The passes at which the labels that differ from a method's in `spp` alone stopped.
json stops_of(const Analysis& analysis, const std::string& scene, std::size_t method) {
    const auto found = analysis.stops.find({scene, analysis.index.methods[method]});
    return found == analysis.stops.end() ? json::array() : json(found->second);
}

json curves_of(const Analysis& analysis, const std::string& scene, const std::string& component) {
    json curves = json::array();
    for (std::size_t m = 0; m < analysis.index.methods.size(); ++m) {
        json points = json::array();
        for (const MeanPoint& p : mean_curve(analysis, scene, analysis.index.methods[m], component)) {
            json point = {p.passes, p.seconds};
            append(point, p.relative_rmse);
            append(point, p.rmse);
            points.push_back(std::move(point));
        }
        if (!points.empty())
            curves.push_back({{"method", m}, {"points", std::move(points)}, {"stops", stops_of(analysis, scene, m)}});
    }
    return curves;
}

json points_of(const std::vector<SpectrumPoint>& curve) {
    json points = json::array();
    for (const auto& p : curve)
        if (p.frequency > 0) points.push_back({p.frequency, number_to_json(p.power)});
    return points;
}

json spectra_of(const Analysis& analysis, const std::string& scene, const std::string& component) {
    json spectra = json::array();
    for (std::size_t m = 0; m < analysis.index.methods.size(); ++m)
        for (const TableRow& row : analysis.rows)
            if (row.scene == scene && row.component == component && row.method == analysis.index.methods[m])
                spectra.push_back({{"method", m},
                                   {"noise", row.noise ? points_of(row.noise->curve) : json::array()},
                                   {"bias", points_of(row.bias)}});
    return spectra;
}

}  // namespace

json report_data(const Analysis& analysis) {
    json scenes = json::object();
    for (const auto& quality : analysis.references) {
        const std::string& scene = quality.scene;
        json entry = {{"components", components_of(analysis, scene)},
                      {"curves", json::object()},
                      {"spectra", json::object()},
                      {"noise_floor", json::object()}};
        for (const auto& component : components_of(analysis, scene)) {
            entry["curves"][component] = curves_of(analysis, scene, component);
            entry["spectra"][component] = spectra_of(analysis, scene, component);
            entry["noise_floor"][component] = std::sqrt(analysis.noise_floor(scene, component));
        }
        scenes[scene] = std::move(entry);
    }
    return {{"methods", analysis.index.methods}, {"targets", target_errors}, {"scenes", std::move(scenes)}};
}

}  // namespace gib
