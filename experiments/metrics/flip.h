#pragma once
// FLIP: the difference that a viewer sees when flipping between two images. Each pixel has a value from 0 (no
// difference) to 1 (the largest difference that a screen can show).
// Sources: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images"; Andersson, Nilsson, Shirley, Akenine-Moller 2021, "Visualizing Errors in Rendered High Dynamic
// Range Images" (HDR-FLIP).
//
// The filters of FLIP: the contrast sensitivity of the eye in
// each colour channel, and the detection of edges and points.
// Source: Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", sections 4.1.1 and 4.2.

#include "common/images/image.h"

#include <numbers>
#include <vector>

namespace gib {

/// Pixels per degree of visual angle for a screen 0.7 m wide with 3840 pixels, seen from 0.7 m: 67.02.
inline constexpr double default_pixels_per_degree = 3840 * std::numbers::pi / 180;

struct FlipMap {
    int width = 0, height = 0;
    std::vector<float> values;  ///< errors in [0, 1], height x width, row 0 on top

    double mean() const;
};

/// The exposures of HDR-FLIP: `count` of them, evenly spaced from `start` to `stop`. Exposure c multiplies radiance
/// by 2^c.
struct ExposureRange {
    double start, stop;
    int count;

    double at(int i) const { return start + (stop - start) * i / (count - 1); }
};

/// The filmic tone curve of ACES in the form that HDR-FLIP uses, for one channel of exposed radiance x >= 0. Its
/// values lie in [0, 1].
double filmic(double x);

/// The range starts at the exposure that maps the reference's largest luminance to 0.85 and stops at the exposure
/// that maps its median luminance to 0.85. It has at least two exposures. If the median is below 2^-24 of the largest
/// luminance (the resolution of float), where the paper has no exposure, the median of the brighter pixels is used
/// instead. A black reference has the range 0 to 0.
ExposureRange flip_exposures(const Image& reference);

/// LDR-FLIP of two images in linear RGB in [0, 1], before the sRGB curve of a screen. It is symmetric, and exactly 0
/// for equal images. Throws InputError if sizes differ, an image is empty, a value is not finite or there is less than
/// one pixel per degree.
FlipMap ldr_flip(const Image& test, const Image& reference, double pixels_per_degree = default_pixels_per_degree);

/// HDR-FLIP of linear radiance: the largest LDR-FLIP of each pixel over the exposures. Negative values count as 0. It
/// is not symmetric, because the exposures are those of the reference. Throws the same errors as ldr_flip().
FlipMap hdr_flip(const Image& test, const Image& reference, double pixels_per_degree = default_pixels_per_degree);

/// One channel of an image, height x width, row 0 on top.
struct Plane {
    int width = 0, height = 0;
    std::vector<float> values;

    Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.f) {}
    const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
    float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// The 2 radius + 1 weights at the offsets -radius to radius [pixels].
using FilterKernel = std::vector<float>;

/// The channels of YCxCz.
enum class OpponentChannel { achromatic, red_green, blue_yellow };

/// A Gaussian whose weights sum to 1, and its share of the filter.
struct GaussianTerm {
    float share;
    FilterKernel kernel;
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
