#pragma once
// Analyses of runs with given curves, as analyse() would make them of a result folder.

#include "experiments/analysis/contest.h"
#include "experiments/analysis/price.h"
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
    for (const auto& scene : scenes_of(analysis)) {
        const Contest contest(analysis, scene);
        for (const auto& [method, runs] : contest.cells()) {
            EqualTimeLook look{.scene = scene,
                               .method = method,
                               .seconds = contest.equal_time(),
                               .first_seconds = first_image_of_all(runs),
                               .passes = runs.front()->last().passes,
                               .image_seconds = runs.front()->last().seconds};
            if (const auto errors2 = errors2_by(runs, Layer::total, look.seconds); !errors2.empty())
                look.error2 = sample_mean(errors2).value;
            analysis.looks.push_back(look);
        }
    }
    return analysis;
}

}  // namespace gib::test
