#include "experiments/analysis/curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

std::vector<std::string> scenes_of(const Analysis& analysis) {
    std::vector<std::string> names;
    for (const Cell& cell : analysis.cells)
        if (std::ranges::find(names, cell.scene) == names.end()) names.push_back(cell.scene);
    return names;
}

std::vector<Layer> layers_of(const Analysis& analysis, const std::string& scene) {
    std::vector<Layer> layers;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.statistics && std::ranges::find(layers, row.layer) == layers.end())
            layers.push_back(row.layer);
    return layers;
}

Analysis with_passes_for_seconds(Analysis analysis) {
    for (Cell& cell : analysis.cells)
        for (CellCheckpoint& c : cell.checkpoints)
            c.checkpoint.seconds = c.checkpoint.passes;
    return analysis;
}

CellsByMethod cells_by_method(const Analysis& analysis, const std::string& scene) {
    CellsByMethod methods;
    for (const Cell& cell : analysis.cells)
        if (cell.scene == scene && !cell.checkpoints.empty()) methods[cell.method].push_back(&cell);
    return methods;
}

double mean_seconds(const Runs& cells) {
    double sum = 0;
    for (const Cell* cell : cells)
        sum += cell->last().seconds;
    return sum / static_cast<double>(cells.size());
}

double first_image_of_all(const Runs& cells) {
    double seconds = 0;
    for (const Cell* cell : cells)
        seconds = std::max(seconds, cell->checkpoints.front().checkpoint.seconds);
    return seconds;
}

bool have_converged(const Runs& cells) {
    return std::ranges::all_of(cells, [](const Cell* cell) { return cell->converged; });
}

Runs without(Runs cells, std::size_t left_out) {
    if (left_out < cells.size()) cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(left_out));
    return cells;
}

std::optional<double> error2_after(const Cell& cell, Layer layer, double seconds) {
    std::optional<std::pair<double, double>> before;  // seconds, rel_mse
    for (const auto& [checkpoint, errors] : cell.checkpoints) {
        const auto found = errors.find(layer);
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

std::vector<double> errors2_by(const Runs& cells, Layer layer, double seconds) {
    const bool all_done = !cells.empty() && mean_seconds(cells) <= seconds;
    std::vector<double> errors;
    for (const Cell* cell : cells)
        if (const auto e = error2_after(*cell, layer, all_done ? std::numeric_limits<double>::infinity() : seconds))
            errors.push_back(*e);
    if (errors.size() < cells.size()) errors.clear();
    return errors;
}

std::vector<MeanPoint> mean_curve(const Runs& cells, Layer layer) {
    std::vector<MeanPoint> curve;
    std::size_t shortest = std::numeric_limits<std::size_t>::max(), longest = 0;
    for (const Cell* cell : cells) {
        shortest = std::min(shortest, cell->checkpoints.size());
        longest = std::max(longest, cell->checkpoints.size());
    }
    if (cells.empty() || shortest == 0) return curve;
    // Appends the point of checkpoint i of each run, or of its last one.
    const auto add = [&](bool last, std::size_t i) {
        MeanPoint point{.least_passes = std::numeric_limits<std::uint32_t>::max()};
        for (const Cell* cell : cells) {
            const auto& [checkpoint, errors] = last ? cell->checkpoints.back() : cell->checkpoints[i];
            const auto error = errors.find(layer);
            if (error == errors.end()) return false;
            point.least_passes = std::min(point.least_passes, checkpoint.passes);
            point.most_passes = std::max(point.most_passes, checkpoint.passes);
            point.seconds += checkpoint.seconds / static_cast<double>(cells.size());
            point.run_seconds.push_back(checkpoint.seconds);
            point.relative.push_back(error->second.rel_mse_corrected);
            point.absolute.push_back(error->second.mse_corrected);
        }
        if (!last && point.least_passes != point.most_passes) return false;
        curve.push_back(std::move(point));
        return true;
    };
    std::size_t common = 0;
    while (common < shortest && add(false, common))
        ++common;
    if (common < longest && !add(true, 0)) return {};
    return curve;
}

}  // namespace gib
