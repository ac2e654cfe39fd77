#pragma once
// Reads an image file as linear floats with OpenImageIO. common/images/image_library.h says which files it
// accepts and how it decodes them.

#include "common/core/error.h"
#include "common/images/image_library.h"

#include <OpenImageIO/imageio.h>
#include <vector>

namespace gib {

/// Opens a file that must be a flat image with pixels. Otherwise throws InputError with the file's name.
std::unique_ptr<OIIO::ImageInput> open_file(const std::string& path, const OIIO::ImageSpec* config = nullptr);
/// Throws InputError if the file has more than one part. To be called before or after the first part is read,
/// not during it.
void require_one_part(OIIO::ImageInput& file, const SourceLocation& where);

/// ImageLibrary::read_linear().
LinearImage read_linear(const std::string& path, bool raw);

}  // namespace gib
