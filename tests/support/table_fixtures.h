#pragma once
// Cells and rows of tables with given numbers, of the scene `box`.

#include "experiments/analysis/table_row.h"
#include "experiments/results/result_folder.h"

#include <cstdint>
#include <string>

namespace gib::test {

inline Cell cell_of(const std::string& method, std::uint64_t seed = 1) {
    Cell cell;
    cell.scene = "box";
    cell.method = method;
    cell.seed = seed;
    return cell;
}

/// An image of a cell with this relative squared error of `total`.
inline CellCheckpoint checkpoint_of(std::uint32_t passes, double seconds, double rel_mse) {
    return {{passes, seconds, {}, 0}, {{Layer::total, {0, 0, 0, rel_mse}}}};
}

/// A run whose relative squared error is floor + c / seconds, with images after first, 2 first, 4 first, ... up to `last`
/// [s].
inline Cell run_of(const std::string& method, double c, double first, double last, double floor = 0,
                   std::uint64_t seed = 1) {
    Cell cell = cell_of(method, seed);
    std::uint32_t passes = 1;
    for (double t = first; t <= last; t *= 2, passes *= 2)
        cell.checkpoints.push_back(checkpoint_of(passes, t, floor + c / t));
    return cell;
}

/// A row with a mean squared error of 1 and this squared bias.
inline TableRow row_of(const std::string& method, Layer layer = Layer::total, const std::optional<Estimate>& bias2 = {},
                       int seeds = 1) {
    TableRow row;
    row.scene = "box";
    row.method = method;
    row.layer = layer;
    row.statistics = ReplicateStatistics{seeds, {1, {}}, {1, {}}, {1, {}}, 1, 1, bias2, {}, {}};
    return row;
}

}  // namespace gib::test
