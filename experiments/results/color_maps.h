#pragma once
// Colours and exposures of the report's images.

#include "common/images/image.h"
#include "experiments/metrics/flip.h"

#include <span>

namespace gib {

/// The factor that brings the image's mean luminance to a middle tone; 1 for a black image.
float exposure_for(const Image& image);

/// sRGB, from the least to the largest value; colours between two steps are their means.
using ColorScale = std::span<const Color>;
/// Black, violet, red, orange, pale yellow: steps of equal lightness, so that twice as bright reads as more.
ColorScale error_colors();
/// Every 17th of the 256 colours of `magma` (Smith and van der Walt, matplotlib): within 0.01 of the others.
ColorScale magma_colors();
/// Blue (too dark), nearly white (no bias), red (too bright).
ColorScale bias_colors();

/// A map of FLIP in the colours of `magma`, as its papers show it. Linear, so that a PNG's curve gives the colours.
Image flip_image(const FlipMap& map);
/// The inverse of flip_image() for a PNG as read_image() gives it: the nearest of 256 values.
FlipMap flip_values(const Image& picture);

}  // namespace gib
