#pragma once
// The bytes of Mitsuba's .vol files.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace gib::test {

/// A file of version 3 with float32 values and the box [0, 1]^3. The channels of `values`
/// vary fastest, then x, y and z.
inline std::string volume_bytes(const std::array<std::int32_t, 3>& size, std::int32_t channels,
                                const std::vector<float>& values) {
    std::string bytes = "VOL\3";
    const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(std::int32_t{1});
    for (const std::int32_t n : size)
        put(n);
    put(channels);
    for (const float corner : {0.f, 0.f, 0.f, 1.f, 1.f, 1.f})
        put(corner);
    for (const float value : values)
        put(value);
    return bytes;
}

}  // namespace gib::test
