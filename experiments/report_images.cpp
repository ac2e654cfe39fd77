#include "experiments/report_images.h"

#include "common/image_file.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gib {

namespace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
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

/// The linear value that the PNG's sRGB curve turns back into `s`.
float linear_of(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }

/// Black, violet, red, orange, pale yellow: steps of equal lightness (sRGB values), so that twice as bright reads as
/// more.
Color scale_color(float t) {
    static const std::array<Color, 5> steps = {Color(0.0f, 0.0f, 0.02f), Color(0.34f, 0.06f, 0.43f),
                                               Color(0.73f, 0.21f, 0.33f), Color(0.98f, 0.55f, 0.04f),
                                               Color(0.99f, 1.0f, 0.64f)};
    const float position = std::clamp(t, 0.f, 1.f) * 4;
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(position), 3);
    const float share = position - static_cast<float>(i);
    const Color srgb = steps[i] * (1 - share) + steps[i + 1] * share;
    return {linear_of(srgb[0]), linear_of(srgb[1]), linear_of(srgb[2])};
}

}  // namespace

std::string png_data_url(const Image& image, float exposure) {
    return "data:image/png;base64," + base64(encode_png(image, exposure));
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
    Image map(x.width, x.height);
    for (std::size_t i = 0; i < map.pixels(); ++i) {
        double error = 0;
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
            const auto reference = static_cast<double>(r.rgb[k]);
            error += std::abs(static_cast<double>(x.rgb[k]) - reference) / std::sqrt(sqr(reference) + epsilon) / 3;
        }
        map.set(i, std::isfinite(error) ? scale_color(static_cast<float>(error / largest)) : Color(1, 0, 1));
    }
    return map;
}

}  // namespace gib
