#pragma once
// The curve of a method's error against time: when it reaches an error, and the law by which its square falls.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <vector>

namespace gib {

/// A point of one run's curve.
struct ErrorPoint {
    double seconds;  ///< charged time, preparation included [s]
    double error2;   ///< relative squared error less the reference's own variance; may be negative
};

/// error^2(t) = floor + factor (t - start)^-slope for t > start.
struct ErrorLaw {
    double floor = 0;   ///< >= 0: the squared error that more time does not remove
    double factor = 0;  ///< > 0 [seconds^slope]
    double slope = 1;   ///< > 0
    double start = 0;   ///< seconds of preparation, before which there is no image

    double error2(double seconds) const;
    /// The time [s] at which the squared error falls to `error2`; empty if the floor is not below it.
    std::optional<double> seconds_to(double error2) const;
    /// The law up to `seconds`, continued with a slope of at most 1: low-discrepancy points, and runs that have not
    /// found their rare paths yet, fall faster at first, but the noise of independent samples falls as 1 / t.
    ErrorLaw no_steeper_after(double seconds) const;
};

/// The time to an error by the law, beyond the measured span.
struct Extrapolation {
    enum class Kind {
        time,      ///< `seconds`, with a 95 % interval
        at_least,  ///< `seconds` is a lower bound: the law may have a floor above the error
        never,     ///< the law has a floor above the error
    };
    Kind kind;
    double seconds = 0;
    std::optional<Interval> interval = std::nullopt;
};

/// The law of one method's runs, with 95 % intervals.
struct PriceLaw {
    ErrorLaw law;
    ErrorLaw floorless;  ///< the best law with floor 0
    ErrorLaw ceiling;    ///< the best law with the highest floor that the runs allow, with a confidence of 99.75 %
    /// The laws of the runs without one in turn; empty below 3 runs, or if one of them has none.
    std::vector<ErrorLaw> without, floorless_without;
    Estimate floor, slope;
    Estimate floorless_slope;
    /// The largest relative deviation of the law from a measured squared error; near 0 where the law holds.
    double misfit = 0, floorless_misfit = 0;
    double last_seconds = 0;  ///< the end of the measured span; the law extrapolates beyond it

    /// Whether the runs have reached an error floor: its interval lies above 0.
    bool stands() const { return floor.interval && floor.interval->lo > 0; }
    /// The time to a squared error that was not measured. The fitted floor does not decide, because 0 is its most
    /// common value where a floor cannot be seen: what decides is how high the floor may be. `has_no_floor`: theory
    /// says so, as for unbiased methods whose samples are all fresh. Empty without intervals, if the slope is at the
    /// end of its range, or if such runs have an error floor: unsampled light, whose time is unknown.
    std::optional<Extrapolation> extrapolate(double error2, bool has_no_floor = false) const;
    /// The 95 % interval of the squared error after `seconds`, without interval for fewer than 3 runs.
    Estimate error2_after(double seconds, bool theory_has_no_floor) const;
};

/// Fits the law to the mean of the runs' squared errors at equal points of their curves, by weighted least squares. The
/// standard deviation of a squared error is taken as proportional to the squared error itself, because the noise of an
/// image's error is relative; the weight of a point is the inverse of its variance. For every slope, floor >= 0 and
/// factor solve a linear problem in two unknowns; the slope is found by a one-dimensional search in [0.1, 4]. Intervals
/// come from the delete-one jackknife over whole runs, because the points of one run are correlated, with Student's t.
/// There are none below 3 runs, nor of a slope at an end of its range. That of the floor holds the floors F at which
/// the derivative of the residual by F, with the best slope and factor for F, does not differ significantly from 0:
/// unlike the fitted floor, which often is exactly 0, it scatters from run to run. The noise of independent samples
/// falls as 1 / t; an error that falls faster at first, as with low-discrepancy points, bends as if there were a floor.
/// So the floor's interval begins at 0 unless the slope at the end of the curve, over the last factor of 4 in t -
/// start, is below 1 with its whole interval.
/// `noise_floor`: the squared error that is lost in the reference's own noise; curves end there. Empty if fewer than
/// 4 points have a positive mean error, or if the squared error falls by less than 1 %.
std::optional<PriceLaw> fit_price_law(const std::vector<std::vector<ErrorPoint>>& runs, double start,
                                      double noise_floor = 0);

/// A checkpoint of a curve of error against time.
struct CurvePoint {
    double seconds, error;
};

/// The time [s] from which on a curve is at or below the target; empty if it ends above.
std::optional<double> crossing_time(const std::vector<CurvePoint>& curve, double target);

/// The time [s] at which the error of a replicate falls to `target` for good, as the mean over replicates in log(time):
/// a curve that a rare bright path raises again has not been there before, it had only not met this light. Between
/// checkpoints, a curve is interpolated in log(time) and log(error). A curve whose first checkpoint is good enough
/// counts with that checkpoint's time, an upper bound, because nothing is extrapolated. The interval is wider on the
/// side of the longer tail. Empty unless all replicates reach the target.
std::optional<Estimate> time_to_error(const std::vector<std::vector<CurvePoint>>& curves, double target);

}  // namespace gib
