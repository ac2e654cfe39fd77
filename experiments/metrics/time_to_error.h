#pragma once
// The time that a method's replicates take to an error.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <vector>

namespace gib {

/// A checkpoint of a curve of error against time.
struct CurvePoint {
    double seconds, error;
};

/// The time [s] from which on a curve is at or below the target; empty if it ends above.
std::optional<double> crossing_time(const std::vector<CurvePoint>& curve, double target);

/// The time [s] at which the error of a replicate falls to `target` for good, as the mean over replicates in log(time): a curve
/// that a rare bright path raises again has not been there before, it had only not met this light. Between checkpoints, a curve is interpolated in log(time) and log(error). A curve whose first checkpoint is good
/// enough counts with that checkpoint's time, an upper bound, because nothing is extrapolated. The interval is wider on
/// the side of the longer tail. Empty unless all replicates reach the target.
std::optional<Estimate> time_to_error(const std::vector<std::vector<CurvePoint>>& curves, double target);

}  // namespace gib
