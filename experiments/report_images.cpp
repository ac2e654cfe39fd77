#include "experiments/report_images.h"

#include "common/image_file.h"
#include "common/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace gib {

namespace {

std::string base64(std::span<const std::uint8_t> bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = (bits << 8) | (k < count ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= count ? digits[(bits >> (18 - 6 * k)) & 63u] : '=';
    }
    return text;
}

/// The colour of `t` in [0, 1] between steps that are sRGB values; linear, so that the PNG's curve turns it back.
Color scale_color(std::span<const Color> steps, float t) {
    const float position = std::clamp(t, 0.f, 1.f) * static_cast<float>(steps.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(position), steps.size() - 2);
    const float share = position - static_cast<float>(i);
    const Color srgb = steps[i] * (1 - share) + steps[i + 1] * share;
    return {linear_from_srgb(srgb[0]), linear_from_srgb(srgb[1]), linear_from_srgb(srgb[2])};
}

/// Black, violet, red, orange, pale yellow: steps of equal lightness, so that twice as bright reads as more.
std::array<Color, 5> error_colors() {
    return {Color(0.0f, 0.0f, 0.02f), Color(0.34f, 0.06f, 0.43f), Color(0.73f, 0.21f, 0.33f),
            Color(0.98f, 0.55f, 0.04f), Color(0.99f, 1.0f, 0.64f)};
}

/// Every 17th of the 256 colours of `magma` (Smith and van der Walt, matplotlib): within 0.01 of the others.
std::array<Color, 16> magma_colors() {
    return {Color(0.001462f, 0.000466f, 0.013866f), Color(0.043830f, 0.033830f, 0.141886f),
            Color(0.123833f, 0.067295f, 0.295879f), Color(0.232077f, 0.059889f, 0.437695f),
            Color(0.341482f, 0.080564f, 0.492631f), Color(0.445163f, 0.122724f, 0.506901f),
            Color(0.550287f, 0.161158f, 0.505719f), Color(0.658483f, 0.196027f, 0.490253f),
            Color(0.767398f, 0.233705f, 0.457755f), Color(0.868793f, 0.287728f, 0.409303f),
            Color(0.944006f, 0.377643f, 0.365136f), Color(0.981000f, 0.498428f, 0.369734f),
            Color(0.994738f, 0.624350f, 0.427397f), Color(0.997228f, 0.747981f, 0.516859f),
            Color(0.993170f, 0.870024f, 0.626189f), Color(0.987053f, 0.991438f, 0.749504f)};
}

}  // namespace

std::string png_data_url(const Image& image, float exposure) {
    return "data:image/png;base64," + base64(encode_png(image, exposure));
}

std::string png_data_url(std::string_view png) {
    return "data:image/png;base64," + base64({reinterpret_cast<const std::uint8_t*>(png.data()), png.size()});
}

float exposure_for(const Image& image) {
    constexpr double middle = 0.3;  // displays as 0.58
    double mean = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i)
        mean += static_cast<double>(luminance(image.at(i)));
    mean /= static_cast<double>(std::max<std::size_t>(image.pixels(), 1));
    return std::isfinite(mean) && mean > 0 ? static_cast<float>(middle / mean) : 1.f;
}

Image error_map(const Image& x, const Image& r, double epsilon, double largest) {
    const auto colors = error_colors();
    Image map(x.width, x.height);
    for (std::size_t i = 0; i < map.pixels(); ++i) {
        double error = 0;
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
            const auto reference = static_cast<double>(r.rgb[k]);
            error += std::abs(static_cast<double>(x.rgb[k]) - reference) / std::sqrt(sqr(reference) + epsilon) / 3;
        }
        map.set(i, std::isfinite(error) ? scale_color(colors, static_cast<float>(error / largest)) : Color(1, 0, 1));
    }
    return map;
}

Image flip_image(const FlipMap& map) {
    const auto colors = magma_colors();
    Image image(map.width, map.height);
    for (std::size_t i = 0; i < image.pixels(); ++i)
        image.set(i, scale_color(colors, map.values[i]));
    return image;
}

}  // namespace gib
