#pragma once
// The record of samples that are not finite: a film counts and drops them.

#include <cstdint>

namespace gib {

/// Samples that were not finite. They are counted and dropped (they count as black). With pass and pixel the first
/// can be reproduced.
struct NonFinite {
    std::uint64_t count = 0;
    std::uint32_t first_pass = 0;
    std::uint64_t first_pixel = 0;
};

}  // namespace gib
