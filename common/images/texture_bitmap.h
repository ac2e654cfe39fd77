#pragma once
// The texels of image files.

#include "common/core/math.h"
#include "common/images/image_library.h"

namespace gib {

/// The linear colours or greys of an image file.
class Bitmap {
public:
    /// Reads a file as ImageLibrary::read_linear() does, and throws the same errors.
    Bitmap(const std::string& path, bool raw);

    int width() const { return image_.width; }
    int height() const { return image_.height; }
    bool grey() const { return image_.channels == 1; }
    /// The texel in column x and row y, row 0 on top.
    Color texel(int x, int y) const {
        const auto pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
        const float* v = image_.values.data() + pixel * static_cast<std::size_t>(image_.channels);
        return grey() ? Color(Color::Constant(*v)) : Color(v[0], v[1], v[2]);
    }

    /// Mean, minimum and maximum of each channel over all texels.
    const Color& mean() const { return mean_; }
    const Color& minimum() const { return minimum_; }
    const Color& maximum() const { return maximum_; }

private:
    LinearImage image_;
    Color mean_, minimum_, maximum_;
};

}  // namespace gib
