#pragma once
// The search for the settings with the least time to an error: a cover of the space and successive halving (Karnin,
// Koren and Somekh 2013; Jamieson and Talwalkar 2016). It measures settings by a callback, so that it can be tested
// with known times.

#include "experiments/tuning/search_space.h"

#include <cstdint>
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
    Setting setting;
    TimeEstimate time;
};

/// Measures settings for `budget` seconds each, all with the seed of this round. The result has their order; a setting
/// that failed has an infinite time, and one for which no time was left has none.
using MeasureTimes = std::function<std::vector<std::optional<TimeEstimate>>(const std::vector<Setting>& settings,
                                                                            std::uint64_t round, double budget)>;

struct SearchOutcome {
    /// The latest trial of every setting that was measured, the best first; trials of longer runs come before those
    /// that were given up earlier. A time that several rounds have measured is their geometric mean.
    std::vector<Trial> trials = {};
    bool is_cut = false;  ///< whether time ran out before the rounds were done
};

/// Each round keeps the better half of what it has measured and doubles the budget, so that all rounds of the whole
/// cover take
/// `seconds` together. A round drops settings whose laws place them four times behind the best. No budget is larger than twice the
/// best time measured so far.
SearchOutcome search(const SearchSpace& space, double seconds, const MeasureTimes& measure);

/// Settings of the cover for each axis, besides the defaults.
inline constexpr std::size_t settings_per_axis = 10;

}  // namespace gib
