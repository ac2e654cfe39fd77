#include "experiments/report/report_data.h"

#include "experiments/analysis/curves.h"
#include "experiments/analysis/drawn_curve.h"
#include "experiments/measuring/measurement_json.h"

#include <algorithm>
#include <cmath>

namespace gib {

using nlohmann::json;

namespace {

void append(json& list, const Estimate& e) {
    list.push_back(number_to_json(e.value));
    list.push_back(e.interval ? number_to_json(e.interval->lo) : json(nullptr));
    list.push_back(e.interval ? number_to_json(e.interval->hi) : json(nullptr));
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
        if (!points.empty()) curves.push_back({{"method", m}, {"points", std::move(points)}});
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
    return {{"methods", analysis.index.methods},
            {"epsilon", analysis.index.epsilon},
            {"targets", target_errors},
            {"scenes", std::move(scenes)}};
}

}  // namespace gib
