#include "experiments/results/color_maps.h"

#include "common/color/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gib {

Color scale_color(ColorScale steps, float t) {
    const float position = std::clamp(t, 0.f, 1.f) * static_cast<float>(steps.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(position), steps.size() - 2);
    const float share = position - static_cast<float>(i);
    return steps[i] * (1 - share) + steps[i + 1] * share;
}

float exposure_for(const Image& image) {
    constexpr double middle = 0.3;  // linear; 0.58 in sRGB
    double mean = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i)
        mean += static_cast<double>(luminance(image.at(i)));
    mean /= static_cast<double>(std::max<std::size_t>(image.pixels(), 1));
    return std::isfinite(mean) && mean > 0 ? static_cast<float>(middle / mean) : 1.f;
}

ColorScale error_colors() {
    static const std::array<Color, 5> colors = {Color(0.0f, 0.0f, 0.02f), Color(0.34f, 0.06f, 0.43f),
                                                Color(0.73f, 0.21f, 0.33f), Color(0.98f, 0.55f, 0.04f),
                                                Color(0.99f, 1.0f, 0.64f)};
    return colors;
}

ColorScale magma_colors() {
    static const std::array<Color, 16> colors = {
        Color(0.001462f, 0.000466f, 0.013866f), Color(0.043830f, 0.033830f, 0.141886f),
        Color(0.123833f, 0.067295f, 0.295879f), Color(0.232077f, 0.059889f, 0.437695f),
        Color(0.341482f, 0.080564f, 0.492631f), Color(0.445163f, 0.122724f, 0.506901f),
        Color(0.550287f, 0.161158f, 0.505719f), Color(0.658483f, 0.196027f, 0.490253f),
        Color(0.767398f, 0.233705f, 0.457755f), Color(0.868793f, 0.287728f, 0.409303f),
        Color(0.944006f, 0.377643f, 0.365136f), Color(0.981000f, 0.498428f, 0.369734f),
        Color(0.994738f, 0.624350f, 0.427397f), Color(0.997228f, 0.747981f, 0.516859f),
        Color(0.993170f, 0.870024f, 0.626189f), Color(0.987053f, 0.991438f, 0.749504f)};
    return colors;
}

ColorScale bias_colors() {
    static const std::array<Color, 5> colors = {Color(0.02f, 0.19f, 0.38f), Color(0.26f, 0.58f, 0.76f),
                                                Color(0.97f, 0.97f, 0.97f), Color(0.84f, 0.38f, 0.30f),
                                                Color(0.40f, 0.00f, 0.12f)};
    return colors;
}

Image flip_image(const FlipMap& map) {
    const ColorScale colors = magma_colors();
    Image image(map.width, map.height);
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const Color srgb = scale_color(colors, map.values[i]);
        image.set(i, {linear_from_srgb(srgb[0]), linear_from_srgb(srgb[1]), linear_from_srgb(srgb[2])});
    }
    return image;
}

FlipMap flip_values(const Image& picture) {
    constexpr int steps = 256;
    std::array<Color, steps> table;
    for (int i = 0; i < steps; ++i)
        table[static_cast<std::size_t>(i)] =
            scale_color(magma_colors(), static_cast<float>(i) / static_cast<float>(steps - 1));
    FlipMap map{picture.width, picture.height, std::vector<float>(picture.pixels())};
    for (std::size_t p = 0; p < picture.pixels(); ++p) {
        const Color linear = picture.at(p);
        const Color color(srgb_from_linear(linear[0]), srgb_from_linear(linear[1]), srgb_from_linear(linear[2]));
        float least = std::numeric_limits<float>::infinity();
        for (int i = 0; i < steps; ++i) {
            const float distance = (color - table[static_cast<std::size_t>(i)]).square().sum();
            if (!(distance < least)) continue;
            least = distance;
            map.values[p] = static_cast<float>(i) / static_cast<float>(steps - 1);
        }
    }
    return map;
}

}  // namespace gib
