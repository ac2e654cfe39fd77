#include "common/images/image.h"

#include <algorithm>
#include <cmath>

namespace gib {

std::size_t Image::non_finite_values() const {
    return static_cast<std::size_t>(std::count_if(rgb.begin(), rgb.end(), [](float v) { return !std::isfinite(v); }));
}

Image& Image::operator+=(const Image& other) {
    for (std::size_t i = 0; i < rgb.size(); ++i)
        rgb[i] += other.rgb[i];
    return *this;
}

Image ComponentImages::total() const {
    Image sum(width, height);
    for (const auto& part : parts)
        if (part) sum += *part;
    return sum;
}

std::optional<Image> ComponentImages::total_bias() const {
    std::optional<Image> sum;
    for (const auto& part : bias) {
        if (!part) continue;
        if (!sum) sum = Image(width, height);
        *sum += *part;
    }
    return sum;
}

}  // namespace gib
