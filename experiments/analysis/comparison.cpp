#include "experiments/analysis/comparison.h"

#include "common/core/number_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace gib {

namespace {

std::optional<EqualTimeRow> equal_time_row(const CellsByMethod& methods, const std::string& scene,
                                           const std::string& component, double seconds, double noise_floor) {
    EqualTimeRow row{.scene = scene, .component = component, .seconds = seconds, .entries = {}};
    for (const auto& [method, cells] : methods)
        if (const auto error = relative_rmse_after(cells, component, seconds, noise_floor))
            row.entries.push_back({method, *error});
    if (row.entries.size() < 2) return std::nullopt;
    std::stable_sort(row.entries.begin(), row.entries.end(),
                     [](const auto& a, const auto& b) { return a.relative_rmse < b.relative_rmse; });
    return row;
}

/// Appends the checkpoints of one method that all seeds have.
void add_points(const std::string& scene, const std::string& method, const std::vector<const Cell*>& cells,
                double noise_floor, std::vector<FrontierPoint>& points) {
    const std::size_t count = common_checkpoints(cells);
    for (std::size_t i = 0; i < count; ++i) {
        const auto passes = cells.front()->checkpoints[i].checkpoint.passes;
        double seconds = 0, error = 0;
        for (const Cell* cell : cells) {
            const auto& [checkpoint, errors] = cell->checkpoints[i];
            const auto total = errors.find(total_name);
            if (total == errors.end()) return;
            seconds += checkpoint.seconds;
            error += total->second.rel_mse_corrected;
        }
        const auto n = static_cast<double>(cells.size());
        points.push_back({.scene = scene,
                          .method = method,
                          .passes = passes,
                          .seconds = seconds / n,
                          .relative_rmse = error / n > noise_floor ? std::sqrt(error / n) : 0.0});
    }
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
                                                                                        const std::string& component) {
    std::map<std::pair<std::string, std::string>, std::map<double, const TableRow*>> found;
    for (const TableRow& row : analysis.rows) {
        if (row.scene != scene || row.component != component) continue;
        const MethodLabel label = MethodLabel::parse(row.method);
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

}  // namespace

double equal_time(const CellsByMethod& methods) {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (const auto& [method, cells] : methods) {
        const bool converged =
            std::all_of(cells.begin(), cells.end(), [](const Cell* cell) { return cell->converged; });
        const double mean = mean_seconds(cells);
        longest = std::max(longest, mean);
        if (!converged) shortest = std::min(shortest, mean);
    }
    return std::min(shortest, longest);
}

std::vector<EqualTimeRow> equal_time_rows(const Analysis& analysis) {
    std::vector<EqualTimeRow> rows;
    for (const auto& scene : scenes_of(analysis)) {
        const CellsByMethod methods = cells_by_method(analysis, scene);
        const double seconds = equal_time(methods);
        for (const auto& component : components_of(analysis, scene)) {
            if (component == total_name && !analysis.unjudged(scene).empty()) continue;
            if (auto row = equal_time_row(methods, scene, component, seconds, analysis.noise_floor(scene, component)))
                rows.push_back(std::move(*row));
        }
    }
    return rows;
}

std::vector<FrontierPoint> pareto_frontier(const Analysis& analysis) {
    std::vector<FrontierPoint> frontier;
    for (const auto& scene : scenes_of(analysis)) {
        const CellsByMethod methods = cells_by_method(analysis, scene);
        if (methods.size() < 2 || !analysis.unjudged(scene).empty()) continue;
        std::vector<FrontierPoint> points;
        for (const auto& [method, cells] : methods)
            add_points(scene, method, cells, analysis.noise_floor(scene, total_name), points);
        std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
            return std::pair(a.seconds, a.relative_rmse) < std::pair(b.seconds, b.relative_rmse);
        });
        double best = std::numeric_limits<double>::infinity();
        for (const auto& point : points) {
            if (!(point.relative_rmse < best)) continue;
            best = point.relative_rmse;
            frontier.push_back(point);
        }
    }
    return frontier;
}

std::vector<BiasLaw> bias_laws(const Analysis& analysis) {
    std::vector<BiasLaw> laws;
    for (const auto& scene : scenes_of(analysis))
        for (const auto& component : components_of(analysis, scene))
            for (const auto& [key, rows] : sweeps(analysis, scene, component)) {
                if (rows.size() < 3) continue;
                BiasLaw law{.scene = scene, .component = component, .method = key.first, .parameter = key.second};
                std::vector<BiasPoint> points;
                for (const auto& [x, row] : rows) {
                    law.values.push_back(x);
                    if (row->is_unbiased || !row->statistics || !row->statistics->bias2) continue;
                    const Estimate& bias2 = *row->statistics->bias2;
                    if (!bias2.interval || !(bias2.interval->lo > 0)) continue;
                    const double width = std::log(bias2.interval->hi / bias2.interval->lo);
                    points.push_back({x, bias2.value, std::max(width, 1e-6) / (2 * 1.96)});
                }
                law.resolved_count = points.size();
                if (points.size() < 3) continue;
                law.exponent = fitted_exponent(points);
                laws.push_back(std::move(law));
            }
    return laws;
}

}  // namespace gib
