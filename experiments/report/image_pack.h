#pragma once
// Packs images as text inside a page: half floats, deflated, in base64. report_page/blobs.js unpacks them.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace gib {

/// Base64 by RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

struct PackedImage {
    int width = 0, height = 0, channels = 0;
    bool bytes = false;  ///< 8 bits a value instead of a half float
    int exponent = 0;    ///< a stored half is the value times 2^exponent
    std::string text;    ///< base64 of zlib's format
};

/// Packs height x width x channels values as half floats. Their relative precision is 2^-11 over 28 stops below the
/// largest value; NaN and infinity are kept. The bytes hold for each channel a plane of high bytes, each as its
/// difference to the left neighbour (to 0 in the first column) modulo 256, and after these for each channel the plane
/// of low bytes. Throws std::invalid_argument if the number of values is another one.
PackedImage pack_half(std::span<const float> values, int width, int height, int channels);

/// Packs one byte a pixel, as differences to the left neighbour like the high bytes of pack_half().
PackedImage pack_bytes(std::span<const std::uint8_t> values, int width, int height);

}  // namespace gib
