#include "experiments/analysis/curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

double mean_seconds(const std::vector<const Cell*>& cells) {
    double sum = 0;
    for (const Cell* cell : cells)
        sum += cell->last().seconds;
    return sum / static_cast<double>(cells.size());
}

std::optional<double> error2_after(const Cell& cell, const std::string& component, double seconds) {
    std::optional<std::pair<double, double>> before;  // seconds, rel_mse
    for (const auto& [checkpoint, errors] : cell.checkpoints) {
        const auto found = errors.find(component);
        if (found == errors.end()) return std::nullopt;
        const std::pair<double, double> here{checkpoint.seconds, found->second.rel_mse_corrected};
        if (here.first >= seconds) {
            if (here.first == seconds) return here.second;
            if (!before) return std::nullopt;
            if (!(before->second > 0) || !(here.second > 0)) return here.second;
            const double s = std::log(seconds / before->first) / std::log(here.first / before->first);
            return before->second * std::pow(here.second / before->second, s);
        }
        before = here;
    }
    return before ? std::optional(before->second) : std::nullopt;
}

std::vector<std::string> components_of(const Analysis& analysis, const std::string& scene) {
    std::vector<std::string> names;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.statistics && std::find(names.begin(), names.end(), row.component) == names.end())
            names.push_back(row.component);
    return names;
}

std::vector<std::string> scenes_of(const Analysis& analysis) {
    std::vector<std::string> names;
    for (const Cell& cell : analysis.cells)
        if (std::find(names.begin(), names.end(), cell.scene) == names.end()) names.push_back(cell.scene);
    return names;
}

CellsByMethod cells_by_method(const Analysis& analysis, const std::string& scene) {
    CellsByMethod methods;
    for (const Cell& cell : analysis.cells)
        if (cell.scene == scene && !cell.checkpoints.empty()) methods[cell.method].push_back(&cell);
    return methods;
}

std::optional<double> mean_error2_after(const std::vector<const Cell*>& cells, const std::string& component,
                                        double seconds) {
    double sum = 0;
    for (const Cell* cell : cells) {
        const auto error = error2_after(*cell, component, seconds);
        if (!error) return std::nullopt;
        sum += *error;
    }
    if (cells.empty()) return std::nullopt;
    return sum / static_cast<double>(cells.size());
}

std::optional<double> mean_error2_by(const std::vector<const Cell*>& cells, const std::string& component,
                                     double seconds) {
    const bool all_done = mean_seconds(cells) <= seconds;
    return mean_error2_after(cells, component, all_done ? std::numeric_limits<double>::infinity() : seconds);
}

std::optional<double> relative_rmse_after(const std::vector<const Cell*>& cells, const std::string& component,
                                          double seconds, double noise_floor) {
    const auto error2 = mean_error2_by(cells, component, seconds);
    return error2 && *error2 > std::max(noise_floor, 0.0) ? std::optional(std::sqrt(*error2)) : std::nullopt;
}

std::size_t common_checkpoints(const std::vector<const Cell*>& cells) {
    if (cells.empty()) return 0;
    for (std::size_t i = 0;; ++i)
        for (const Cell* cell : cells)
            if (i >= cell->checkpoints.size() ||
                cell->checkpoints[i].checkpoint.passes != cells.front()->checkpoints[i].checkpoint.passes)
                return i;
}

}  // namespace gib
