#pragma once
// Images of one value, and changed images.

#include "common/images/image_file.h"

#include <algorithm>

namespace gib::test {

inline Image constant_image(float value, int width, int height) {
    Image image(width, height);
    std::fill(image.rgb.begin(), image.rgb.end(), value);
    return image;
}

inline Image constant_image(const Color& color, int width, int height) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.pixels(); ++i)
        image.set(i, color);
    return image;
}

/// The image with f(v) for each value v.
template <class F>
Image mapped(Image image, const F& f) {
    for (float& v : image.rgb)
        v = static_cast<float>(f(v));
    return image;
}

/// A file with this image alone.
inline LayeredImage one_layer(Image image) { return {{{"", std::move(image)}}, {}}; }

}  // namespace gib::test
