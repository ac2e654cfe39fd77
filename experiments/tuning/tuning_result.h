#pragma once
// The findings of a tuning, and the numbers that its text and its page show.

#include "experiments/metrics/student_t.h"
#include "experiments/results/result_folder.h"
#include "experiments/tuning/halving_search.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// The search among the settings of one method.
struct TunedMethod {
    MethodLabel base;  ///< label as asked for: the defaults beside its own values
    std::vector<TuningAxis> axes;
    std::vector<Trial> trials;  ///< all settings that were measured, the best first
};

/// A label of the final measurement.
struct FinalSetting {
    MethodLabel label;
    std::size_t method;       ///< index of its TunedMethod
    std::vector<Cell> cells;  ///< cells of the fresh seeds
    /// Natural logarithms of the seconds to the target; empty: not all runs have reached it, or there are fewer than two.
    std::vector<double> log_times = {};
    SampleMean mean{0, {0, 1}};  ///< mean of log_times
};

struct TuningResult {
    std::string scene;        ///< name
    std::string target;       ///< relative RMSE, as asked for
    double target_error = 0;  ///< the same as a share
    double final_budget = 0;  ///< seconds of each final run
    double minutes = 0;       ///< time that was asked for
    double used_seconds = 0;  ///< time that reference, search and final runs took
    std::vector<TunedMethod> methods = {};
    std::vector<FinalSetting> finals = {};  ///< the best first, those that have not reached the target last
    std::vector<std::string> notes = {};    ///< steps that were cut short for lack of time

    bool has_best() const { return !finals.empty() && !finals.front().log_times.empty(); }
    const FinalSetting& best() const { return finals.front(); }
};

/// Seconds to the target with the 95 % interval of the mean in the logarithm (Student's t). `f` has reached it.
Estimate seconds_of(const FinalSetting& f);

/// The factor by which a setting takes longer than `best`, with its 95 % interval. Both have reached the target.
Estimate factor_between(const FinalSetting& other, const FinalSetting& best);
/// Whether the interval of a factor holds 1.
inline bool holds_one(const Estimate& factor) { return factor.interval->lo <= 1 && factor.interval->hi >= 1; }

/// Errors for which the time of the best setting is shown, too, as shares.
inline constexpr double errors_along_the_way[] = {0.10, 0.05, 0.02, 0.01};
/// The seconds of the best setting to these errors, for those that all of its runs have reached.
std::vector<std::pair<double, Estimate>> times_along_the_way(const TuningResult& result);

/// The words for what a label changes of the best one: "photons halved", "the defaults", "cache=on"; empty for another
/// method or for several changes.
std::string change_of(const TuningResult& result, const FinalSetting& other);

/// The gain of the best settings of a method over its defaults.
struct Speedup {
    std::size_t method;                   ///< index
    const FinalSetting* best;             ///< best setting of this method
    std::optional<Estimate> factor = {};  ///< the defaults' time over the best one's
    /// A lower bound of the factor where the defaults have not reached the target in their runs.
    std::optional<double> at_least = {};
};
/// One for each method that has something to vary, has reached the target and whose defaults were measured.
std::vector<Speedup> speedups(const TuningResult& result);
/// The same as a sentence: "photon_mapper is 3.4 (2.9 to 4.0) times faster than with its defaults".
std::string sentence_of(const TuningResult& result, const Speedup& speedup);

/// The label of the best setting with the samples a pixel that the target takes.
std::string label_to_paste(const TuningResult& result);

}  // namespace gib
