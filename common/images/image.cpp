#include "common/images/image.h"

#include <algorithm>
#include <cmath>

namespace gib {

std::size_t Image::non_finite_values() const {
    return static_cast<std::size_t>(std::count_if(rgb.begin(), rgb.end(), [](float v) { return !std::isfinite(v); }));
}

namespace {

void add(std::vector<float>& sum, const std::vector<float>& terms) {
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += terms[i];
}

}  // namespace

Image ComponentImages::total() const {
    Image sum(width, height);
    for (const auto& part : parts)
        if (part) add(sum.rgb, part->rgb);
    return sum;
}

std::optional<Image> ComponentImages::total_bias() const {
    std::optional<Image> sum;
    for (const auto& part : bias) {
        if (!part) continue;
        if (!sum) sum = Image(width, height);
        add(sum->rgb, part->rgb);
    }
    return sum;
}

}  // namespace gib
