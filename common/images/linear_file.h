#pragma once
// Reads image files as linear colours, as Mitsuba does. Environment maps are made from them.

#include "common/images/image.h"

#include <string>

namespace gib {

/// Linear RGB with sRGB's primaries, row 0 on top.
using LinearImage = Image;

/// Reads a whole file. Throws InputError with the file's name if ImageLibrary::open_image() refuses the file or a
/// value is not finite.
LinearImage load_linear_image(const std::string& path);

}  // namespace gib
