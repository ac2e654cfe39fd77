#pragma once
// The price of accuracy: for each method of a scene the law of its error against time and the cost of halving its
// error, and for the scene the times at which the best method changes.

#include "experiments/analysis/curves.h"
#include "experiments/metrics/price_law.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The law of a component, fitted to the checkpoints that all cells of a method have. The start of the law is their
/// mean preparation time [s]. `noise_floor` is the relative squared error that is lost in the reference's own noise.
std::optional<PriceLaw> price_law_of(const std::vector<const Cell*>& cells, const std::string& component,
                                     double noise_floor);

/// The measured factor by which time grew for the last halving of a method's error: the time of the last common
/// checkpoint over the time at which the mean error was twice as large. From 3 runs on it has a 95 % interval
/// (delete-one jackknife over the runs, in the logarithm). Empty if the error was never twice as large, or if the
/// last error is not above the noise floor.
std::optional<Estimate> last_halving(const std::vector<const Cell*>& cells, const std::string& component,
                                     double noise_floor);

/// The part of a law's floor that is bias^2, taken from the relative bias^2 of
/// the final images. The rest is variance that more time does not remove, such as
/// that of a fixed photon map. 0 without a law, without an estimate of bias^2, or if the method is unbiased.
double floor_bias2(const TableRow& row);

/// A change of the best method: from `seconds` on, `method` is closer to the reference than the others.
struct Crossover {
    std::string scene, method;
    std::string before = "";  ///< the best method until then; empty: none had an image
    double seconds;           ///< charged time [s]
    /// 95 % interval of `seconds`, by the delete-one jackknife over the seeds of both methods in log(time). Empty
    /// below 3 seeds, or if `method` does not pass `before` in one of the means that leave out a seed.
    std::optional<Interval> interval = std::nullopt;
    double relative_rmse;  ///< relative RMSE of `method` at that time; 0: not above the noise floor
};

/// The changes of the best method, by time, in every scene with two methods or more whose light is judged completely.
/// Curves are means over the seeds. An error that is not above the noise floor counts as
/// 0; after the end of a run its error stays constant. Two methods with equal errors take
/// turns by chance, so that a change counts only if the new method becomes closer by 5 %.
std::vector<Crossover> crossovers(const Analysis& analysis);

}  // namespace gib
