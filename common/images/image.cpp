#include "common/images/image.h"

#include <algorithm>
#include <cmath>

namespace gib {

std::size_t Image::non_finite_values() const {
    return static_cast<std::size_t>(std::count_if(rgb.begin(), rgb.end(), [](float v) { return !std::isfinite(v); }));
}

Image ComponentImages::total() const {
    Image sum(width, height);
    for (const auto& part : parts)
        if (part)
            for (std::size_t i = 0; i < sum.rgb.size(); ++i)
                sum.rgb[i] += part->rgb[i];
    return sum;
}

}  // namespace gib
