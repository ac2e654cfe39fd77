#pragma once
// Image files row by row as linear floats, the way Mitsuba reads them: what textures and environment maps start from.

#include "common/images/image.h"

#include <memory>
#include <string>

namespace gib {

class ImageReader;

/// Linear RGB with sRGB's primaries, row 0 on top.
using LinearImage = Image;

/// An open image file of one grey channel or of R, G and B. Alpha and other channels are left out and never multiplied
/// in. 8- and 16-bit integers are decoded as sRGB whatever the file says, floats are linear: Mitsuba's rule. A data
/// window is the whole image.
class LinearFile {
public:
    /// `raw`: values as they are stored, 8- and 16-bit integers as fractions of their range. Throws InputError with the
    /// file's name if it is missing, is not an image, has several parts, subsampled colour or primaries of its own.
    LinearFile(const std::string& path, bool raw);
    ~LinearFile();
    LinearFile(LinearFile&&) noexcept;

    int width() const;
    int height() const;
    int channels() const;  ///< 1 or 3
    /// Rows [begin, end), interleaved, to `values`. Throws InputError for damaged data. Safe from several threads.
    void read_rows(int begin, int end, float* values) const;

private:
    std::unique_ptr<ImageReader> reader_;
};

/// Throws InputError with the file's name: for what LinearFile refuses, and for a value that is not finite.
LinearImage load_linear_image(const std::string& path);

}  // namespace gib
