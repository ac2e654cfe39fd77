#pragma once
// Colours and exposures of the report's images.

#include "common/images/image.h"
#include "experiments/metrics/flip.h"

#include <span>

namespace gib {

/// The factor that brings the image's mean luminance to a middle tone; 1 if the mean is 0 or not finite.
float exposure_for(const Image& image);

/// The steps of a colour scale in sRGB, from the smallest to the largest value, with
/// linear interpolation between them.
using ColorScale = std::span<const Color>;
/// The colour of a scale at `t`, which is clamped to [0, 1].
Color scale_color(ColorScale steps, float t);
/// Black, violet, red, orange, pale yellow in steps of equal lightness, so that lighter means a larger error.
ColorScale error_colors();
/// Every 17th of the 256 colours of `magma` (Smith and van der Walt, matplotlib); interpolation is within
/// 0.01 of the rest.
ColorScale magma_colors();
/// Blue (too dark), nearly white (no bias), red (too bright).
ColorScale bias_colors();

/// A map of FLIP in the colours of `magma`, as in the papers on FLIP. The values are linear, so that the sRGB curve
/// of a PNG gives the colours of the scale.
Image flip_image(const FlipMap& map);
/// The inverse of flip_image() for a PNG that read_image() has read. Each value is the nearest of 256.
FlipMap flip_values(const Image& picture);

}  // namespace gib
