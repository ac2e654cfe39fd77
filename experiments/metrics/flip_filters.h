#pragma once
// The filters of FLIP: the contrast sensitivity of the eye in
// each colour channel, and the detection of edges and points.
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

/// The 2 radius + 1 weights at the offsets -radius to radius [pixels].
using Kernel = std::vector<float>;

/// Both functions repeat the outermost pixels of the image beyond its borders.
Plane filtered_along_rows(const Plane& plane, const Kernel& kernel);
Plane filtered_along_columns(const Plane& plane, const Kernel& kernel);

/// The channels of YCxCz.
enum class OpponentChannel { achromatic, red_green, blue_yellow };

/// A Gaussian whose weights sum to 1, and its share of the filter.
struct GaussianTerm {
    float share;
    Kernel kernel;
};

/// The contrast sensitivity of a channel as a filter: a sum of Gaussians whose shares sum to 1. `pixels_per_degree`
/// counts the pixels per degree of visual angle and is at least 1.
std::vector<GaussianTerm> contrast_filter(OpponentChannel channel, double pixels_per_degree);
Plane contrast_filtered(const Plane& plane, OpponentChannel channel, double pixels_per_degree);

/// The strength of edges and points, >= 0: the magnitudes of the first and of the second derivatives along both axes.
struct Features {
    Plane edges, points;
};

/// Filters with the derivatives of a Gaussian whose standard deviation is half of 0.082 degrees. Their positive
/// weights sum to 1, their negative weights to -1. `luminance` is relative to white.
Features detected_features(const Plane& luminance, double pixels_per_degree);

}  // namespace gib
