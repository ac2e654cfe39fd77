#pragma once
// The plan that divides the time left after the search among the final runs.

#include <cstddef>

namespace gib {

/// The limits of the final measurement.
struct FinalNeeds {
    std::size_t labels;  ///< all that are worth it, the most important first
    std::size_t least;   ///< how many of them run in any case
    int seeds;           ///< runs of each label
    double left;         ///< seconds for all runs
    double besides;      ///< seconds that a run takes besides its budget
    double shortest;     ///< seconds to the target of the best label, as the search saw it; infinite: not known
};

struct FinalPlan {
    std::size_t labels;  ///< how many run
    double budget;       ///< seconds of each run
};

/// The most labels that can run for 1.5 times the shortest time, which the best of them need to reach the target; none
/// runs longer than three times, as it is enough to know that it takes that long. The `least` labels get at most a third
/// of the time each seed, so that two seeds and that of the search end in time.
FinalPlan plan_finals(const FinalNeeds& needs);

/// The longest time [s] that runs of so many labels can get if all of them end in `seconds`.
double longest_final(double seconds, std::size_t labels);

}  // namespace gib
