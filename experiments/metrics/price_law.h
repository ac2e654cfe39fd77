#pragma once
// The law that a method's squared error follows with time, fitted to its measured curve.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <vector>

namespace gib {

/// A point of one run's curve.
struct ErrorPoint {
    double seconds;  ///< charged, preparation included
    double error2;   ///< relative squared error, the reference's own variance subtracted: may be negative
};

/// error^2(t) = floor + factor (t - start)^-slope for t > start.
struct ErrorLaw {
    double floor = 0;   ///< >= 0: what more time does not remove
    double factor = 0;  ///< > 0 [seconds^slope]
    double slope = 1;   ///< > 0
    double start = 0;   ///< seconds of preparation, before which there is no image

    double error2(double seconds) const;
    /// When the squared error falls to `error2`; empty if the floor is not below it.
    std::optional<double> seconds_to(double error2) const;
};

/// The law of one method's runs, with 95 % intervals.
struct PriceLaw {
    ErrorLaw law;
    ErrorLaw floorless;  ///< the best law with floor 0: what is left if the floor is not resolved
    Estimate floor, slope;
    /// Share of the squared error by which the worst point is off the law: near 0 where the law holds.
    double misfit = 0;
    double first_seconds = 0, last_seconds = 0;  ///< what was measured; beyond, the law extrapolates
    /// What the time has to be multiplied by, from the last point on, for half its error. Extrapolated. Empty: the
    /// floor is above that, or was fitted and is not resolved, so that only a lower bound is known (extrapolate()).
    std::optional<Estimate> next_halving;

    /// What is known of the time to a squared error that was not measured.
    struct Extrapolation {
        double seconds;
        bool at_least;  ///< by the law without floor, as the floor that was fitted is not resolved, or not down to here
    };
    /// Empty: never, as far as the runs' scatter can tell.
    std::optional<Extrapolation> extrapolate(double error2) const;
};

/// Fits the mean of the runs' squared errors at equal points of their curves (equal passes): weighted least squares,
/// the weight of a point the inverse of its squared error's variance (the scatter of the runs, pooled, proportional to
/// the squared error itself: noise of an image's error is relative). For every slope, floor >= 0 and factor are the
/// solution of a linear problem of two unknowns; the slope is found by a search of one dimension in [0.1, 4].
/// Intervals: delete-one jackknife over whole runs, as the points of one run are correlated, with Student's t; that of
/// the floor is cut off at 0. No intervals below 3 runs. Noise of independent samples falls as 1 / t; what falls faster
/// at first, as low-discrepancy points do, bends as if there were a floor. So the floor's interval begins at 0 unless
/// the slope at the curve's end, over the last factor of 4 in t - start, is below 1 with its whole interval. Empty if
/// fewer than 4 points have a positive mean error, or if the squared error falls by less than 1 %. `noise_floor`: the
/// squared error below which the reference resolves nothing; curves end there.
std::optional<PriceLaw> fit_price_law(const std::vector<std::vector<ErrorPoint>>& runs, double start,
                                      double noise_floor = 0);

}  // namespace gib
