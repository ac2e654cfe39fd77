#pragma once
// The times of a tuning: to an error, from the checkpoints of one short run, for the search, and of all final runs of a
// setting.

#include "experiments/results/result_folder.h"
#include "experiments/tuning/halving_search.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace gib {

/// The time of one run to the relative RMSE `target` of the total image: the crossing of its curve, else by the fitted
/// law of price_law.h. With fewer points than a law needs, the squared error falls as 1 / (t - t0), as that of
/// independent samples does. Infinite if the law's floor lies above the target. Beyond `horizon`, the longest time [s]
/// that a run can be given, settings are ranked by their error e at the horizon: the cost is horizon e^2 / target^2,
/// the time of a method whose squared error falls as 1 / t. An image later than the horizon counts at its own time.
TimeEstimate estimated_time(const Cell& cell, double target, double horizon = std::numeric_limits<double>::infinity());

/// The time to a target, or the reason why there is none, as the runs of a setting show it.
struct Verdict {
    enum State {
        measured,       ///< all runs have reached it
        extrapolated,   ///< by the law; the interval of `seconds` may have no upper end
        not_reachable,  ///< the law's floor, or the error of all converged runs, is above it
        no_image        ///< there is no run
    } state = no_image;
    std::size_t runs = 0, reached = 0;  ///< runs, and how many of them have reached the target
    double error = 0,
           seconds_of_error = 0;         ///< relative RMSE of the final images and their time [s], means over the runs
    Estimate seconds = {NAN, {}};        ///< to the target, if it is measured or extrapolated [s]
    Estimate floor = {NAN, {}};          ///< relative RMSE that more time does not remove, if it is not reachable
    std::uint32_t passes = 0;            ///< to the target, as far as it is known; else of the final images
    std::vector<double> log_times = {};  ///< natural logarithms of the runs' seconds to a target that is measured
};

/// `is_unbiased`: the floor is known to be 0. Times that were not measured are those of PriceLaw::extrapolate(); fewer than three runs
/// or four points have no such law; only unbiased methods have a time without it.
Verdict verdict_of(const std::vector<Cell>& cells, double target, bool is_unbiased);

}  // namespace gib
