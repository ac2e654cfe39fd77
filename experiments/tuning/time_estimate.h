#pragma once
// The time to an error from the checkpoints of cells.

#include "experiments/results/result_folder.h"
#include "experiments/tuning/halving_search.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The time of one run to the relative RMSE `target` of the total image: the crossing of its curve, else by the fitted
/// law of price_law.h. With fewer points than a law needs, the squared error falls as 1 / (t - t0), as that of
/// independent samples does. Infinite if the law's floor lies above the target.
TimeEstimate estimated_time(const Cell& cell, double target);

/// The time of each run to `target`, as natural logarithms of seconds; empty unless all runs reach it.
std::vector<double> log_times(const std::vector<Cell>& cells, double target);

/// The fewest passes, mean over the runs in the logarithm and rounded up, after which the target is reached; empty
/// unless all runs reach it.
std::optional<std::uint32_t> passes_to(const std::vector<Cell>& cells, double target);

}  // namespace gib
