#pragma once
// Errors of images against a reference. Several replicates of
// a method give its bias and its variance, with intervals.

#include "experiments/metrics/denominators.h"
#include "experiments/metrics/student_t.h"

#include <optional>
#include <vector>

namespace gib {

/// Errors by the plain formulas, each a mean over pixels and channels. x is the image and r the reference.
struct ImageError {
    double mse;      ///< (x - r)^2
    double rel_mse;  ///< (x - r)^2 / (r_total^2 + epsilon)
    /// Unbiased estimates of mse and rel_mse against the truth (Denominators); may be negative.
    double mse_corrected, rel_mse_corrected;
};

/// The denominators are those of the reference's total, also for a component; `truth` is made of `reference` and them.
/// A value of x that is not finite makes the result not finite. Throws InputError if sizes differ.
ImageError image_error(const Image& x, const ReferenceLayer& reference, const Denominators& denominators,
                       const NoisyTruth& truth);
ImageError image_error(const Image& x, const ReferenceLayer& reference, const Denominators& denominators);

struct Interval {
    double lo, hi;
};

/// A value with its 95 % interval; no interval where there are too few replicates to give one.
struct Estimate {
    double value;
    std::optional<Interval> interval;
};

/// A value with the 95 % interval that these variances give (half_width()); none if one of them is not known.
Estimate estimate(double value, const std::vector<VarianceTerm>& terms);

/// A statistic with the 95 % interval of the delete-one jackknife (Efron and Stein 1981), by Student's t with n - 1
/// degrees of freedom. `without` holds the values of the statistic when each of the n >= 2 runs is left out in turn.
/// The interval misses the truth with probability `tail`, both sides together.
Estimate jackknife(double value, const std::vector<double>& without, double tail = 0.05);

/// The errors of one method, from several independently seeded images.
struct ReplicateStatistics {
    int seeds;
    Estimate mse, rmse, rel_mse;  ///< mse and rel_mse: means over the replicates; rmse = sqrt(mse)
    /// Estimates against the truth (ImageError). rmse_corrected is NaN where the reference's variance exceeds the
    /// error; rel_mse_corrected is unclipped.
    double rmse_corrected, rel_mse_corrected;
    std::optional<Estimate> bias2;     ///< from 2 seeds on: mean of (E x - r)^2, unbiased, unclipped
    std::optional<Estimate> variance;  ///< from 2 seeds on: mean over pixels of the unbiased variance of a replicate
    /// Relative squared bias, as bias2; rel_mse_corrected - rel_bias2 is the relative variance.
    std::optional<Estimate> rel_bias2;
    /// -2 <mean x - R, G_g - R> / rel_mse_corrected for each group G_g of the reference: how much log rel_mse_corrected
    /// changes if the reference R moves by G_g - R (first order, no unit; ranking.h). Empty without groups, and where
    /// rel_mse_corrected is not positive.
    std::vector<double> pulls = {};
    /// How much log rel_mse_corrected changes if the reference has missed the light that it may have missed; <= 0
    /// (analysis/unsampled_light.h).
    double missed_shift = 0;
};

/// Without a standard error of the reference, mse = bias2 + variance. Intervals come from the scatter of the seeds
/// and of the reference's groups (statistics.cpp has the derivation). The interval of `variance` needs 3 seeds. The
/// intervals of mse, rmse and rel_mse belong to the plain formulas, whose expectation contains the reference's
/// variance. A NaN in a replicate gives NaN and no interval.
ReplicateStatistics replicate_statistics(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                                         const Denominators& denominators);

/// The noise floor of a reference: the relative squared error that is lost in the reference's own noise. For an exact
/// image, one in forty references as noisy as this one shows a larger error after its own variance is subtracted. The
/// floor is 1.96 standard errors of the mean of the squared noise, from the scatter of the groups; noise that is
/// correlated over many pixels exceeds it twice as often. Without groups, the errors of pixels and channels are taken
/// as independent. 0 without a standard error.
double noise_floor_of(const ReferenceLayer& reference, const Denominators& denominators);

}  // namespace gib
