#pragma once
// The filters of FLIP: what the eye resolves of each colour channel, and where it sees edges and points.
// Source: Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", sections 4.1.1 and 4.2.

#include <vector>

namespace gib {

/// One channel of an image, height x width, row 0 on top.
struct Plane {
    int width = 0, height = 0;
    std::vector<float> values;

    Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.f) {}
    const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
    float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// Weights at the offsets -radius to radius, 2 radius + 1 of them.
using Kernel = std::vector<float>;

/// Both repeat the image's outermost pixels beyond its borders.
Plane filtered_along_rows(const Plane& plane, const Kernel& kernel);
Plane filtered_along_columns(const Plane& plane, const Kernel& kernel);

/// The channels of YCxCz.
enum class OpponentChannel { achromatic, red_green, blue_yellow };

/// A Gaussian whose weights sum to 1, and its share of the filter.
struct GaussianTerm {
    float share;
    Kernel kernel;
};

/// The contrast sensitivity of a channel as a filter: a sum of Gaussians, shares sum to 1. `pixels_per_degree`: of
/// visual angle, >= 1.
std::vector<GaussianTerm> contrast_filter(OpponentChannel channel, double pixels_per_degree);
Plane contrast_filtered(const Plane& plane, OpponentChannel channel, double pixels_per_degree);

/// How strong edges and points are, >= 0: the lengths of the first and of the second derivatives along both axes.
struct Features {
    Plane edges, points;
};

/// The derivatives of a Gaussian whose standard deviation is half of 0.082 degrees, positive and negative weights
/// summing to 1 and to -1. `luminance` is relative to white.
Features detected_features(const Plane& luminance, double pixels_per_degree);

}  // namespace gib
