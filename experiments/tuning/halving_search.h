#pragma once
// The search for the settings with the least time to an error: successive halving (Karnin, Koren and Somekh 2013;
// Jamieson and Talwalkar 2016), then steps to better neighbours. It sees settings as labels and measures them by a
// callback, so that it can be tested with known times.

#include "experiments/tuning/search_space.h"

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace gib {

/// The time to the target as a short run shows it.
struct TimeEstimate {
    double seconds =
        std::numeric_limits<double>::infinity();  ///< by the measured curve, else by its law; infinite: never
    /// The target was reached, so that `seconds` is no extrapolation.
    bool is_measured = false;
    /// Cost of a time beyond the horizon of estimated_time() [s]; empty below it.
    std::optional<double> beyond = {};

    /// The time that the search minimises [s].
    double cost() const { return beyond.value_or(seconds); }
};

struct Trial {
    MethodLabel label;
    TimeEstimate time;
};

/// Measures labels for `budget` seconds each, all with the same seed. `round` counts the calls. The result has the order of
/// the labels; a label that failed gets an infinite time, and one for which no time was left gets none.
using MeasureTimes = std::function<std::vector<std::optional<TimeEstimate>>(const std::vector<MethodLabel>& labels,
                                                                            double budget, int round)>;

struct SearchSettings {
    double seconds = 60;      ///< time for all runs together
    int labels_per_axis = 6;  ///< number of labels besides the defaults
    int most_steps = 8;       ///< limit on the steps of the descent to better neighbours
    /// The seconds that the search has taken so far, with all that a run takes besides its budget; empty: the sum of the
    /// budgets.
    std::function<double()> elapsed = {};
};

struct SearchOutcome {
    /// The latest trial of every label that was measured, the best first; trials of longer runs stand before those that
    /// were given up earlier. It has at least one.
    std::vector<Trial> trials;
    bool is_cut = false;  ///< whether time ran out before the rounds were done
};

/// Each round of halving keeps the better half and doubles the budget, and drops a label that the laws place `hopeless`
/// times behind the best. No budget is larger than twice the best time measured so far, and no round begins that
/// would take longer than what is left. The descent then goes to the best neighbour, tries all changes together that
/// gained one by one, and repeats a change as long as it gains (Hooke and Jeeves 1961, "Direct Search Solution of Numerical
/// and Statistical Problems"). Where no change gains, it looks for a second one beside the one that loses least.
SearchOutcome search(const MethodLabel& base, const std::vector<TuningAxis>& axes, const SearchSettings& settings,
                     const MeasureTimes& measure);

/// How many times longer than the best a label may seem to take. A law of a short run is often wrong by a factor of two.
inline constexpr double hopeless = 4;

}  // namespace gib
