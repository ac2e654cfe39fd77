#pragma once
// Relative squared errors that do not depend on a few very wrong pixels, for use beside the plain mean rel_mse. One
// firefly of 1e8 in a million pixels makes rel_mse 1e10, which says nothing about the other pixels.

#include "experiments/metrics/reference_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gib {

/// The median; for an even number of values, the mean of the two in the middle. Reorders the values, which may not be
/// empty.
template <typename Number>
double median_of(std::vector<Number>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const auto upper = static_cast<double>(*middle);
    if (values.size() % 2 == 1) return upper;
    return (upper + static_cast<double>(*std::max_element(values.begin(), middle))) / 2;
}

/// The trimmed mean leaves out one pixel in this many, the worst, and at least
/// one. With normal noise these pixels hold about a hundredth of the error, E[z^2;
/// z^2 > 10.83] = 0.013, or less if the noise of the channels is independent.
inline constexpr std::size_t pixels_per_outlier = 1000;
/// If the worst pixels hold this share of rel_mse or more, rel_mse says more about them than about the image.
inline constexpr double outlier_share_to_flag = 0.5;

/// Statistics of the errors of pixels. The error of a pixel is the mean of (x - r)^2 / (r_total^2 + epsilon) over its
/// channels. All three are NaN if an image has a value that is not finite.
struct RobustError {
    double median;   ///< median over the pixels, mean over the replicates
    double trimmed;  ///< mean without the worst ceil(pixels / 1000) pixels of each replicate; NaN for one pixel
    double share;    ///< part of all replicates' rel_mse that those worst pixels hold, in [0, 1]; NaN if rel_mse is 0
};

/// All images have the size of `reference`, with one pixel or more, and there is at least one replicate.
RobustError robust_error(const std::vector<Image>& replicates, const Image& reference, const Image& r_total,
                         double epsilon);

/// Whether the worst pixels hold `outlier_share_to_flag` of the error or more, and there are other pixels.
inline bool is_decided_by_outliers(const RobustError& error) {
    return !std::isnan(error.trimmed) && !std::isnan(error.share) && error.share >= outlier_share_to_flag;
}

}  // namespace gib
