#pragma once
// Analyses of runs with given curves, as analyse() would make them of a result folder.

#include "experiments/analysis/ranking.h"
#include "experiments/analysis/row_fields.h"
#include "tests/support/table_fixtures.h"

#include <set>
#include <vector>

namespace gib::test {

/// An analysis of these cells with the rows of their totals and the looks at equal time.
inline Analysis analysis_of(const std::vector<Cell>& cells) {
    Analysis analysis;
    analysis.cells = cells;
    std::set<std::uint64_t> seeds;
    for (const Cell& cell : cells)
        seeds.insert(cell.seed);
    analysis.index.seeds = static_cast<int>(seeds.size());
    for (const auto& scene : scenes_of(analysis))
        for (const auto& [method, runs] : cells_by_method(analysis, scene)) {
            TableRow row = row_of(method, Layer::total, {}, static_cast<int>(runs.size()));
            row.scene = scene;
            row.seeds = static_cast<int>(runs.size());
            row.seconds = mean_seconds(runs);
            row.statistics->rel_mse_corrected = sample_mean(errors2_by(runs, Layer::total, INFINITY)).value;
            row.statistics->rel_mse = {row.statistics->rel_mse_corrected, {}};
            add_curve_numbers(row, runs);
            analysis.rows.push_back(row);
            analysis.index.methods.push_back(method);
        }
    for (const auto& scene : scenes_of(analysis))
        for (const auto& [method, runs] : cells_by_method(analysis, scene))
            analysis.looks.push_back({.scene = scene,
                                      .method = method,
                                      .passes = runs.front()->last().passes,
                                      .seconds = runs.front()->last().seconds});
    return analysis;
}

}  // namespace gib::test
