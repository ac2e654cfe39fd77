#pragma once
// Images as text inside a page: half floats, deflated, in base64. The page's script (report/blobs.js) is the inverse.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace gib {

/// RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

struct PackedImage {
    int width = 0, height = 0, channels = 0;
    bool bytes = false;  ///< 8 bits a value instead of a half float
    int exponent = 0;    ///< a stored half is the value times 2^exponent
    std::string text;    ///< base64 of zlib's format
};

/// Half floats (relative precision 2^-11 over 28 stops below the largest value; NaN and infinity are kept) of
/// height x width x channels values. Stored: for each channel a plane of high bytes, each as its difference to the
/// left neighbour (0 left of the first), modulo 256; then for each channel the plane of low bytes.
PackedImage pack_half(std::span<const float> values, int width, int height, int channels);

/// One byte a pixel: the differences as above.
PackedImage pack_bytes(std::span<const std::uint8_t> values, int width, int height);

}  // namespace gib
