#include "experiments/analysis/comparison.h"

#include "common/core/number_text.h"
#include "experiments/analysis/price.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace gib {

namespace {

/// The contests over the totals of the scenes in which a method can be best.
std::vector<std::pair<std::string, Contest>> contests_of(const Analysis& analysis) {
    std::vector<std::pair<std::string, Contest>> contests;
    for (const auto& scene : scenes_of(analysis)) {
        Contest contest(analysis, scene);
        if (contest.methods() > 1 && contest.is_judged()) contests.emplace_back(scene, std::move(contest));
    }
    return contests;
}

std::optional<double> positive_number(const std::string& text) {
    const auto value = number_from<double>(text);
    return value && *value > 0 ? value : std::nullopt;
}

struct BiasPoint {
    double x, bias2, deviation;  ///< deviation: standard error of log bias2
};

/// Fits a line to log bias^2 over log x, in which each point has the weight 1 / deviation^2. The interval widens if
/// the points scatter more than their deviations predict.
Estimate fitted_exponent(const std::vector<BiasPoint>& points) {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (const auto& p : points) {
        const double weight = 1 / (p.deviation * p.deviation), x = std::log(p.x), y = std::log(p.bias2);
        w += weight;
        wx += weight * x;
        wy += weight * y;
        wxx += weight * x * x;
        wxy += weight * x * y;
    }
    const double determinant = w * wxx - wx * wx;
    const double slope = (w * wxy - wx * wy) / determinant, offset = (wy - slope * wx) / w;
    double chi2 = 0;
    for (const auto& p : points) {
        const double residual = (std::log(p.bias2) - offset - slope * std::log(p.x)) / p.deviation;
        chi2 += residual * residual;
    }
    const double scatter = std::max(1.0, chi2 / static_cast<double>(points.size() - 2));
    const double half = 1.96 * std::sqrt(w / determinant * scatter);
    return {-slope, Interval{-slope - half, -slope + half}};
}

/// Groups of rows whose labels differ only in the value of one parameter: (label without the parameter, its name) ->
/// (value, row).
std::map<std::pair<std::string, std::string>, std::map<double, const TableRow*>> sweeps(const Analysis& analysis,
                                                                                        const std::string& scene,
                                                                                        Layer layer) {
    std::map<std::pair<std::string, std::string>, std::map<double, const TableRow*>> found;
    for (const TableRow& row : analysis.rows) {
        if (row.scene != scene || row.layer != layer) continue;
        const MethodLabel label = MethodLabel::parse(analysis.label_of(row.method));
        for (std::size_t i = 0; i < label.values.size(); ++i) {
            const auto value = positive_number(label.values[i].second);
            if (!value) continue;
            MethodLabel rest = label;
            rest.values.erase(rest.values.begin() + static_cast<std::ptrdiff_t>(i));
            found[{rest.text(), label.values[i].first}][*value] = &row;
        }
    }
    return found;
}

/// The exponent p of bias^2 = c x^-p of a density estimate over a disc of radius r. Where light is smooth, the bias of the
/// k nearest of N photons is proportional to r^2, as odd terms of its Taylor series cancel, so that bias^2 ~ r^4; the disc
/// holds k photons, so that r^2 ~ k / N (Jensen 2001, chapter 7; Silverman 1986, section 5.2). k=auto grows as N^(2/3).
/// Final gathering and the cache have biases of their own.
std::optional<double> theoretical_exponent(const MethodLabel& rest, const std::string& parameter, Layer layer) {
    const auto value = [&](const char* key) {
        const auto found = std::ranges::find_if(rest.values, [&](const auto& v) { return v.first == key; });
        return found == rest.values.end() ? std::string() : found->second;
    };
    const bool gathers = !value("gather").empty() && value("gather") != "0";
    if (rest.name != "photon_mapper" || (gathers && layer != Layer::caustic)) return std::nullopt;
    if (parameter == "photons") return value("k") == "auto" ? 2. / 3 : 2;
    if (parameter == "k") return -2;
    return std::nullopt;
}

}  // namespace

std::vector<EqualTimeRow> equal_time_rows(const Analysis& analysis) {
    std::vector<EqualTimeRow> rows;
    for (const auto& scene : scenes_of(analysis))
        for (const Layer layer : layers_of(analysis, scene)) {
            const Contest contest(analysis, scene, layer);
            if (!contest.is_judged()) continue;
            const double seconds = contest.equal_time();
            auto ranking = contest.after(seconds);
            if (ranking.size() < 2 || ranking[1].standing == Standing::no_image) continue;
            rows.push_back({scene, layer, seconds, std::move(ranking), contest.noise_floor()});
        }
    return rows;
}

std::vector<FrontierPoint> pareto_frontier(const Analysis& analysis) {
    std::vector<FrontierPoint> frontier;
    for (const auto& [scene, contest] : contests_of(analysis)) {
        std::map<std::pair<double, double>, FrontierPoint> points;  // by time and squared error
        for (const auto& [method, cells] : contest.cells())
            for (const MeanPoint& point : mean_curve(cells, Layer::total)) {
                const double error2 = sample_mean(point.relative).value;
                if (std::isnan(error2)) continue;
                points.try_emplace({point.seconds, std::max(error2, contest.noise_floor())},
                                   FrontierPoint{.scene = scene,
                                                 .method = method,
                                                 .least_passes = point.least_passes,
                                                 .most_passes = point.most_passes,
                                                 .seconds = point.seconds,
                                                 .relative_rmse = resolved({error2, {}}, contest.noise_floor())});
            }
        double best = std::numeric_limits<double>::infinity();
        for (auto& [place, point] : points) {
            if (!(place.second < best)) continue;
            best = place.second;
            point.doubts = doubts_about(point.method, contest.after(point.seconds));
            frontier.push_back(std::move(point));
        }
    }
    return frontier;
}

std::vector<BiasLaw> bias_laws(const Analysis& analysis) {
    std::vector<BiasLaw> laws;
    for (const auto& scene : scenes_of(analysis))
        for (const Layer layer : layers_of(analysis, scene))
            for (const auto& [key, rows] : sweeps(analysis, scene, layer)) {
                if (rows.size() < 3) continue;
                BiasLaw law{.scene = scene,
                            .layer = layer,
                            .method = key.first,
                            .parameter = key.second,
                            .rows = {rows.begin(), rows.end()},
                            .theory = theoretical_exponent(MethodLabel::parse(key.first), key.second, layer)};
                if (std::ranges::all_of(rows, [](const auto& row) { return row.second->is_unbiased; })) continue;
                std::vector<BiasPoint> points;
                for (const auto& [x, row] : rows) {
                    if (row->is_unbiased || !row->statistics || !row->statistics->bias2) continue;
                    const Estimate& bias2 = *row->statistics->bias2;
                    if (!bias2.interval || !(bias2.interval->lo > 0)) continue;
                    const double width = std::log(bias2.interval->hi / bias2.interval->lo);
                    points.push_back({x, bias2.value, std::max(width, 1e-6) / (2 * 1.96)});
                }
                law.resolved_count = points.size();
                if (points.size() >= 3) law.exponent = fitted_exponent(points);
                laws.push_back(std::move(law));
            }
    return laws;
}

}  // namespace gib
