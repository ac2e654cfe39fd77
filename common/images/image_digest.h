#pragma once
// What an image holds, as a short text: two images are the same bit for bit if and only if their digests are.

#include "common/images/image_file.h"

#include <string>

namespace gib {

/// SHA-1 of the names, sizes and pixels of all layers, in whatever order, and of the metadata named in `keys`; 40
/// hexadecimal digits. Compression and what else is stored in the file do not matter.
std::string image_digest(const LayeredImage& image, const std::vector<std::string>& keys = {});

}  // namespace gib
