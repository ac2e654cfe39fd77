#pragma once
// Images for the report: PNGs inside the page, and maps of where the error is.

#include "common/image.h"

#include <string>

namespace gib {

/// An image as `data:image/png;base64,...`.
std::string png_data_url(const Image& image, float exposure);

/// The factor that brings the image's mean luminance to a middle tone; 1 for a black image.
float exposure_for(const Image& image);

/// |x - r| / sqrt(r^2 + epsilon), mean of the channels, in a colour scale from 0 (dark) to `largest` (bright). Not
/// finite: magenta.
Image error_map(const Image& x, const Image& r, double epsilon, double largest);

}  // namespace gib
