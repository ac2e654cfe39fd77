#pragma once
// The time to an error from the checkpoints of cells.

#include "experiments/results/result_folder.h"
#include "experiments/tuning/halving_search.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The time of one run to the relative RMSE `target` of the total image: the crossing of its curve, else by the fitted
/// law of price_law.h. With fewer points than a law needs, the squared error falls as 1 / (t - t0), as that of
/// independent samples does. Infinite if the law's floor lies above the target.
/// Beyond `horizon`, the longest time [s] that a run can be given, times are as good as infinite, and settings are told
/// apart by the error e that they have there: their cost is horizon e^2 / target^2, which goes on from the horizon
/// without a step, because a method whose squared error falls as 1 / t needs this time. An image later than the horizon
/// counts at its own time.
TimeEstimate estimated_time(const Cell& cell, double target, double horizon = std::numeric_limits<double>::infinity());

/// The time of each run to `target`, as natural logarithms of seconds; empty unless all runs reach it.
std::vector<double> log_times(const std::vector<Cell>& cells, double target);

/// The fewest passes, mean over the runs in the logarithm and rounded up, after which the target is reached; empty
/// unless all runs reach it.
std::optional<std::uint32_t> passes_to(const std::vector<Cell>& cells, double target);

}  // namespace gib
