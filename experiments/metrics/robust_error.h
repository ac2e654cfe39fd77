#pragma once
// Relative squared errors that a few pixels cannot decide, beside the plain mean: one firefly of 1e8 in a million
// pixels makes rel_mse 1e10 and says nothing of the others.

#include "experiments/metrics/reference_image.h"

#include <cmath>
#include <optional>
#include <vector>

namespace gib {

/// The pixels that are left out: the worst one in so many, at least one. Of normal noise they hold about a hundredth of
/// the error: E[z^2; z^2 > 10.83] = 0.013, or less where the channels' noise is independent.
inline constexpr std::size_t pixels_per_outlier = 1000;
/// From this share on, the mean says more about them than about the image.
inline constexpr double outlier_share_to_flag = 0.5;

/// Of each pixel's error, the mean over the channels of (x - r)^2 / (r_total^2 + epsilon). Not a number if an image has
/// a value that is not finite.
struct RobustError {
    double median;   ///< over the pixels (of two in the middle their mean), mean over the replicates
    double trimmed;  ///< mean over the pixels but the worst, ceil(pixels / 1000) of each replicate; NaN of one pixel
    double share;    ///< of those worst pixels in rel_mse, all replicates together, in [0, 1]; NaN where rel_mse is 0
};

/// All of the size of `reference`; at least one replicate with a pixel or more. Throws std::invalid_argument.
RobustError robust_error(const std::vector<Image>& replicates, const Image& reference, const Image& r_total,
                         double epsilon);

/// Whether few pixels hold most of the error, and there are others.
inline bool is_decided_by_outliers(const RobustError& error) {
    return !std::isnan(error.trimmed) && !std::isnan(error.share) && error.share >= outlier_share_to_flag;
}

}  // namespace gib
