#include "experiments/report/report_data.h"

#include "common/core/error.h"
#include "experiments/analysis/comparison.h"
#include "experiments/analysis/curves.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/metrics/student_t.h"
#include "experiments/text/html.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace gib {

using nlohmann::json;

namespace {

/// The square root of the mean of squared errors, less the reference's own variance. Its 95 % interval comes from
/// Student's t over the scatter of the seeds alone and is symmetric in the logarithm; one seed has none.
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

/// Appends a value and its interval, with nulls for what is missing.
void append(json& numbers, const std::optional<Estimate>& e) {
    numbers.push_back(e ? number_to_json(e->value) : json(nullptr));
    numbers.push_back(e && e->interval ? number_to_json(e->interval->lo) : json(nullptr));
    numbers.push_back(e && e->interval ? number_to_json(e->interval->hi) : json(nullptr));
}

/// The passes at which the labels that differ from a method's in `spp` alone stopped.
json stops_of(const Analysis& analysis, const std::string& scene, std::size_t method) {
    const auto found = analysis.stops.find({scene, analysis.index.methods[method]});
    return found == analysis.stops.end() ? json::array() : json(found->second);
}

/// The points of a curve that logarithmic axes can show: times and errors above 0, and errors above the noise floor.
json points_of(const Runs& cells, Layer layer, double noise_floor) {
    const auto drawn = [](double v) { return std::isfinite(v) && v > 0; };
    json points = json::array();
    for (const MeanPoint& p : mean_curve(cells, layer)) {
        const Estimate relative = root_of_mean(p.relative), absolute = root_of_mean(p.absolute);
        if (!drawn(p.seconds) || !drawn(relative.value) || !(relative.value > noise_floor) || !drawn(absolute.value))
            continue;
        json point = {p.most_passes, p.seconds};
        append(point, relative);
        append(point, absolute);
        point.push_back(p.least_passes);
        points.push_back(std::move(point));
    }
    return points;
}

json curves_of(const Analysis& analysis, const std::string& scene, Layer layer) {
    json curves = json::array();
    const CellsByMethod cells = cells_by_method(analysis, scene);
    const double noise_floor = std::sqrt(analysis.noise_floor(scene, layer));
    for (std::size_t m = 0; m < analysis.index.methods.size(); ++m) {
        const auto found = cells.find(analysis.index.methods[m]);
        if (found == cells.end()) continue;
        if (json points = points_of(found->second, layer, noise_floor); !points.empty())
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

/// Theory says of unbiased methods that there is no bias; what the seeds show of it is noise.
json spectra_of(const Analysis& analysis, const std::string& scene, Layer layer) {
    json spectra = json::array();
    for (std::size_t m = 0; m < analysis.index.methods.size(); ++m)
        if (const TableRow* row = analysis.row(scene, analysis.index.methods[m], layer))
            spectra.push_back({{"method", m},
                               {"noise", row->noise ? points_of(row->noise->curve) : json::array()},
                               {"bias", row->is_unbiased ? json::array() : points_of(row->bias)}});
    return spectra;
}

/// A point of a sweep: x, bias^2 and variance with their intervals, and the mean squared error.
json point_of(double x, const TableRow& row) {
    json point = {number_to_json(x)};
    for (const auto part : {&ReplicateStatistics::bias2, &ReplicateStatistics::variance})
        append(point, row.statistics ? (*row.statistics).*part : std::nullopt);
    const Field mse = corrected_mse_field(row);
    point.push_back(mse.is_measured() ? number_to_json(mse.value) : json(nullptr));
    return point;
}

/// The sweeps of a scene: for each method and parameter the points and the law of each component.
json sweeps_of(const std::vector<BiasLaw>& laws, const std::string& scene) {
    json sweeps = json::array();
    for (const BiasLaw& law : laws) {
        if (law.scene != scene) continue;
        auto sweep = std::ranges::find_if(
            sweeps, [&](const json& s) { return s["method"] == law.name && s["parameter"] == law.parameter; });
        if (sweep == sweeps.end())
            sweep = sweeps.insert(
                sweeps.end(), json{{"method", law.name}, {"parameter", law.parameter}, {"components", json::object()}});
        json points = json::array(), exponent;
        for (const auto& [x, row] : law.rows)
            points.push_back(point_of(x, *row));
        if (law.fit) append(exponent, law.fit->exponent);
        (*sweep)["components"][std::string(name_of(law.layer))] = {
            {"points", std::move(points)},
            {"exponent", exponent},
            {"factor", law.fit ? json(law.fit->factor) : json(nullptr)},
            {"resolved", law.resolved_count},
            {"theory", law.theory}};
    }
    return sweeps;
}

}  // namespace

json report_data(const Analysis& analysis) {
    json scenes = json::object();
    const std::vector<BiasLaw> laws = bias_laws(analysis);
    for (const auto& quality : analysis.references) {
        const std::string& scene = quality.scene;
        json entry = {{"components", json::array()},
                      {"curves", json::object()},
                      {"spectra", json::object()},
                      {"noise_floor", json::object()}};
        for (const Layer layer : layers_of(analysis, scene)) {
            const std::string name(name_of(layer));
            entry["components"].push_back(name);
            entry["curves"][name] = curves_of(analysis, scene, layer);
            entry["spectra"][name] = spectra_of(analysis, scene, layer);
            entry["noise_floor"][name] = std::sqrt(analysis.noise_floor(scene, layer));
        }
        entry["sweeps"] = sweeps_of(laws, scene);
        scenes[scene] = std::move(entry);
    }
    return {{"methods", analysis.index.methods}, {"targets", target_errors}, {"scenes", std::move(scenes)}};
}

void add_tuning(const ResultFolder& folder, json& page, json& numbers) {
    page["tuning"] = nullptr;
    page["tuning_section"] = embedded_file("report_page/tuning.html");
    const std::string file = folder.file("tune.json");
    if (!std::filesystem::exists(file)) return;
    try {
        json tuning = numbers["tuning"] = read_json(file);
        tuning["charts"] = json::array();
        for (std::size_t m = 0; m < tuning.at("methods").size(); ++m) {
            json& method = tuning["methods"][m];
            method["best"] = tuning.at("best") == m;
            if (!method.at("parameters").empty())
                tuning["charts"].push_back({{"number", m}, {"base", method.at("base")}});
        }
        page["tuning"] = std::move(tuning);
    } catch (const json::exception& error) {
        throw InputError({file}, fmt::format("not the numbers of a tuning: {}", error.what()));
    }
}

}  // namespace gib
