#pragma once
// FLIP: how much of a difference a viewer sees who flips between two images, per pixel from 0 (none) to 1 (the largest
// that a screen can show).
// Sources: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images"; Andersson, Nilsson, Shirley, Akenine-Moller 2021, "Visualizing Errors in Rendered High Dynamic
// Range Images" (HDR-FLIP).

#include "common/images/image.h"

#include <numbers>
#include <vector>

namespace gib {

/// Of visual angle: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m. 67.02.
inline constexpr double default_pixels_per_degree = 3840 * std::numbers::pi / 180;

struct FlipMap {
    int width = 0, height = 0;
    std::vector<float> values;  ///< in [0, 1], height x width, row 0 on top

    double mean() const;
};

/// The exposures of HDR-FLIP: `count` of them, evenly from `start` to `stop`. Exposure c multiplies with 2^c.
struct ExposureRange {
    double start, stop;
    int count;

    double at(int i) const { return start + (stop - start) * i / (count - 1); }
};

/// ACES' filmic curve for one channel of a scene's radiance x >= 0, as HDR-FLIP has it; in [0, 1].
double filmic(double x);

/// From the exposure that shows the brightest luminance of the reference as 0.85 to the one that shows its median so;
/// two exposures at least. A median below 2^-24 of the largest luminance (float's resolution), where the paper has no
/// exposure, is taken of the brighter pixels alone. 0 to 0 for a black reference.
ExposureRange flip_exposures(const Image& reference);

/// LDR-FLIP of linear RGB in [0, 1] as a screen shows it, that is before sRGB's curve. Symmetric; exactly 0 for equal
/// images. Throws InputError if sizes differ, an image is empty, a value is not finite or there is less than one pixel
/// per degree.
FlipMap ldr_flip(const Image& test, const Image& reference, double pixels_per_degree = default_pixels_per_degree);

/// HDR-FLIP of linear radiance: the largest LDR-FLIP of each pixel over the exposures. Negative values count as 0. Not
/// symmetric: the exposures are those of the reference. Throws as ldr_flip.
FlipMap hdr_flip(const Image& test, const Image& reference, double pixels_per_degree = default_pixels_per_degree);

}  // namespace gib
