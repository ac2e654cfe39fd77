#pragma once
// Images for the report: PNGs inside the page, and maps of where the error is.

#include "common/image.h"
#include "experiments/flip.h"

#include <string>
#include <string_view>

namespace gib {

/// An image, or a PNG file's content, as `data:image/png;base64,...`.
std::string png_data_url(const Image& image, float exposure);
std::string png_data_url(std::string_view png);

/// The factor that brings the image's mean luminance to a middle tone; 1 for a black image.
float exposure_for(const Image& image);

/// |x - r| / sqrt(r^2 + epsilon), mean of the channels, in a colour scale from 0 (dark) to `largest` (bright). Not
/// finite: magenta.
Image error_map(const Image& x, const Image& r, double epsilon, double largest);

/// A map of FLIP in the colours of `magma`, as its papers show it.
Image flip_image(const FlipMap& map);

}  // namespace gib
