#pragma once
// FLIP: the difference that a viewer sees when flipping between two images. Each pixel has a value from 0 (no
// difference) to 1 (the largest difference that a screen can show).
// Sources: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images"; Andersson, Nilsson, Shirley, Akenine-Moller 2021, "Visualizing Errors in Rendered High Dynamic
// Range Images" (HDR-FLIP).

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
/// for equal images. Throws InputError if sizes differ, an image is empty, a value is not finite or there is less
/// than one pixel per degree.
FlipMap ldr_flip(const Image& test, const Image& reference, double pixels_per_degree = default_pixels_per_degree);

/// HDR-FLIP of linear radiance: the largest LDR-FLIP of each pixel over the exposures. Negative values count as 0. It
/// is not symmetric, because the exposures are those of the reference. Throws the same errors as ldr_flip().
FlipMap hdr_flip(const Image& test, const Image& reference, double pixels_per_degree = default_pixels_per_degree);

}  // namespace gib
