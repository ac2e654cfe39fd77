#pragma once
// The price of accuracy over the methods of a scene: the law of each, the cost of halving its error, and when the best
// method changes.

#include "experiments/analysis/curves.h"
#include "experiments/metrics/price_law.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The fitted law of a component, from the checkpoints that all cells of a method have; its start is their mean
/// preparation. `noise_floor`: squared errors from here down are below what the reference resolves.
std::optional<PriceLaw> price_law_of(const std::vector<const Cell*>& cells, const std::string& component,
                                     double noise_floor);

/// The factor by which time grew for the last halving of a method's error, as measured: the time of the last common
/// checkpoint over that at which the mean error was twice as large, with a 95 % interval (delete-one jackknife over the
/// runs, in the logarithm) from 3 runs on. Empty if it never was twice as large, or if the end is below what the
/// reference resolves.
std::optional<Estimate> last_halving(const std::vector<const Cell*>& cells, const std::string& component,
                                     double noise_floor);

/// How much of a law's floor is bias^2, by the relative bias^2 of the final images; the rest is variance that more time
/// does not remove, as that of a fixed photon map. 0 without a law or without a split.
double floor_bias2(const TableRow& row);

/// From `seconds` on, `method` is closer to the reference than the others.
struct Crossover {
    std::string scene, method;
    std::string before;  ///< the best until then; empty: none had an image
    double seconds;      ///< charged
    /// 95 %, delete-one jackknife over the seeds of both methods, in log(time); empty below 3 seeds, or where some of
    /// the means without one seed do not change places.
    std::optional<Interval> interval;
    double relative_rmse;  ///< of `method`, there; 0: below what the reference resolves
};

/// Of every scene with two methods or more, by time. Curves are means over the seeds, errors below what the
/// reference resolves count as none; after a run's end its error stays.
/// Two methods that are level take turns by chance: a change counts if the new one becomes closer by 5 %.
std::vector<Crossover> crossovers(const Analysis& analysis);

}  // namespace gib
