#pragma once
// Reads image files row by row as linear floats, as Mitsuba does. Textures and environment maps are made from them.

#include "common/images/image.h"

#include <memory>
#include <string>

namespace gib {

class ImageReader;

/// Linear RGB with sRGB's primaries, row 0 on top.
using LinearImage = Image;

/// An open image file with one grey channel or with R, G and B. Alpha and other channels are left out, and colours
/// are never multiplied by alpha. By Mitsuba's rule, 8- and 16-bit integers are decoded as sRGB whatever the file
/// says, and floats are linear. The image is the file's data window.
class LinearFile {
public:
    /// If `raw` is true, values are not decoded: 8- and 16-bit integers become fractions of their range. Throws
    /// InputError with the file's name if the file is missing, is not an image, has several parts, subsampled colour
    /// or primaries other than sRGB's.
    LinearFile(const std::string& path, bool raw);
    ~LinearFile();
    LinearFile(LinearFile&&) noexcept;

    int width() const;
    int height() const;
    int channels() const;  ///< 1 or 3
    /// Writes rows [begin, end) to `values`: (end - begin) x width x channels, interleaved. Throws InputError if the
    /// data are damaged. Several threads may call this function.
    void read_rows(int begin, int end, float* values) const;

private:
    std::unique_ptr<ImageReader> reader_;
};

/// Reads a whole file. Throws InputError with the file's name if LinearFile refuses the file or a value
/// is not finite.
LinearImage load_linear_image(const std::string& path);

}  // namespace gib
