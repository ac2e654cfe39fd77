#pragma once
// The digest of an image is a short text: two images are the same bit for bit if and only if their digests are equal.

#include "common/images/image_file.h"

#include <string>

namespace gib {

/// SHA-1 (40 hexadecimal digits) of the names, sizes and pixels of all layers, whatever their order, and of the
/// metadata named in `keys`. The file's compression and its other metadata do not matter.
std::string image_digest(const LayeredImage& image, const std::vector<std::string>& keys = {});

}  // namespace gib
