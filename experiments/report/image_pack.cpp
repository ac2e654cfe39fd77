#include "experiments/report/image_pack.h"

#include "common/core/error.h"

#include <nettle/base64.h>
#include <zlib.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace gib {

namespace {

std::string deflated_text(const std::vector<std::uint8_t>& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::vector<std::uint8_t> packed(size);
    if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK)
        throw RunError("an image cannot be compressed for the report");
    packed.resize(size);
    return base64(packed);
}

/// Appends rows of `width` bytes as differences to the left neighbour.
void append_differences(std::span<const std::uint8_t> plane, int width, std::vector<std::uint8_t>& out) {
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const unsigned left = i % static_cast<std::size_t>(width) == 0 ? 0u : plane[i - 1];
        out.push_back(static_cast<std::uint8_t>(plane[i] - left));
    }
}

/// The exponent of the power of two that brings the largest finite value to [2^14, 2^15); halves end at 65504.
int scale_exponent(std::span<const float> values) {
    float largest = 0;
    for (const float v : values)
        if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
    if (largest == 0) return 0;
    int exponent = 0;
    std::frexp(largest, &exponent);
    return 15 - exponent;
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
    std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
    base64_encode_raw(text.data(), bytes.size(), bytes.data());
    return text;
}

PackedImage pack_half(std::span<const float> values, int width, int height, int channels) {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const auto count = static_cast<std::size_t>(channels);
    if (values.size() != pixels * count) throw std::invalid_argument("an image's size is not that of its values");
    PackedImage packed{
        .width = width, .height = height, .channels = channels, .exponent = scale_exponent(values), .text = {}};
    std::vector<std::uint8_t> bytes, low, high(pixels);
    bytes.reserve(2 * values.size());
    low.reserve(values.size());
    for (std::size_t c = 0; c < count; ++c) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const auto half =
                Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(std::ldexp(values[count * i + c], packed.exponent)));
            high[i] = static_cast<std::uint8_t>(half >> 8);
            low.push_back(static_cast<std::uint8_t>(half & 255u));
        }
        append_differences(high, width, bytes);
    }
    bytes.insert(bytes.end(), low.begin(), low.end());
    packed.text = deflated_text(bytes);
    return packed;
}

PackedImage pack_bytes(std::span<const std::uint8_t> values, int width, int height) {
    std::vector<std::uint8_t> bytes;
    append_differences(values, width, bytes);
    return {.width = width, .height = height, .channels = 1, .bytes = true, .text = deflated_text(bytes)};
}

}  // namespace gib
