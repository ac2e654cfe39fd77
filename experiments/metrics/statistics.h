#pragma once
// Errors of images against a reference, and of replicates: bias and variance apart, with intervals.

#include "experiments/metrics/reference_image.h"

#include <optional>
#include <vector>

namespace gib {

/// The plain formulas: means over pixels and channels. x: the image, r: the reference.
struct ImageError {
    double mse;                               ///< (x - r)^2
    double rmse;                              ///< sqrt(mse)
    double rel_mse;                           ///< (x - r)^2 / (r_total^2 + epsilon)
    double mse_corrected, rel_mse_corrected;  ///< with the reference's own variance subtracted; may be negative
};

/// `r_total` is the reference's total image: the denominator, also of a component. Non-finite values of x spread to the
/// result.
ImageError image_error(const Image& x, const ReferenceLayer& reference, const Image& r_total, double epsilon);

struct Interval {
    double lo, hi;
};

/// A value with its 95 % interval; no interval where there are too few replicates to give one.
struct Estimate {
    double value;
    std::optional<Interval> interval;
};

/// A statistic with the 95 % interval of the delete-one jackknife (Efron and Stein 1981), Student's t with n - 1
/// degrees of freedom. `without`: its values without each of the n >= 2 runs in turn.
Estimate jackknife(double value, const std::vector<double>& without);

/// What several independently seeded images of one method say about it.
struct ReplicateStatistics {
    int seeds;
    Estimate mse, rmse, rel_mse;  ///< mse and rel_mse: means over the replicates; rmse = sqrt(mse)
    /// With the reference's own variance subtracted. rmse_corrected is NaN where the error is below what the reference
    /// resolves; rel_mse_corrected is unclipped.
    double rmse_corrected, rel_mse_corrected;
    std::optional<Estimate> bias2;     ///< from 2 seeds on: mean of (E x - r)^2, unbiased, unclipped
    std::optional<Estimate> variance;  ///< from 2 seeds on: mean over pixels of the unbiased variance of ONE replicate
    /// As bias2, of the relative error: rel_mse_corrected less this is the variance's part of it.
    std::optional<Estimate> rel_bias2;
};

/// Without a reference's standard error, mse = bias2 + variance. Intervals come from the scatter of the seeds and of
/// the reference's groups (statistics.cpp has the derivation); that of `variance` needs 3 seeds; those of mse, rmse and
/// rel_mse are of the plain formulas, whose expectation contains the reference's variance. NaN in a replicate gives NaN
/// and no interval.
ReplicateStatistics replicate_statistics(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                                         const Image& r_total, double epsilon);

/// The relative squared error below which a reference resolves nothing: what an image without any error seems to have,
/// its own variance subtracted, in one of forty references as noisy as this one (1.96 standard errors of the mean of
/// the squared noise, from the scatter of its groups; noise that is correlated over many pixels exceeds it twice as
/// often). Without groups, pixels and channels are taken as independent; 0 without a standard error.
double noise_floor_of(const ReferenceLayer& reference, const Image& r_total, double epsilon);

/// Where each replicate's falling error-against-time curve crosses `target`, interpolated between its checkpoints in
/// log(time) and log(error): the mean over replicates in log(time). Empty if fewer than all reach it. A curve whose
/// first checkpoint is good enough counts with that checkpoint's time, an upper bound: nothing is extrapolated.
struct CurvePoint {
    double seconds, error;
};
std::optional<Estimate> time_to_error(const std::vector<std::vector<CurvePoint>>& curves, double target);

}  // namespace gib
