#pragma once
// Reads numbers from binary files.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace gib {

/// The number that is stored at `bytes`, with its lowest byte first (little) or last (big).
template <typename T>
T load(const char* bytes, std::endian order = std::endian::little) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, raw.size());
    if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

}  // namespace gib
