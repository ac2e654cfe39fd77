#pragma once
// The z test that Mitsuba 3 applies to its own renderings (its src/render/tests/test_renders.py). It compares every
// pixel with a converged reference, using the variance of one sample that is stored with the reference.

#include "common/images/image.h"

#include <cstddef>
#include <cstdint>

namespace gib {

struct MitsubaZTest {
    static constexpr double significance = 0.01;
    static constexpr double least_share = 0.9975;  ///< share of the values that have to pass

    std::size_t values = 0;     ///< pixels x 3 (X, Y and Z)
    std::size_t passing = 0;    ///< values whose p is above `threshold`
    std::size_t nonfinite = 0;  ///< values whose statistic is not finite; they do not pass
    double threshold = 0;       ///< `significance` with Sidak's correction for the number of pixels
    double smallest_p = 1;
    int x = 0, y = 0;         ///< pixel of `smallest_p`, row 0 on top
    std::size_t channel = 0;  ///< channel of `smallest_p`: 0, 1, 2 for X, Y, Z
    double share() const { return static_cast<double>(passing) / static_cast<double>(values); }
    bool accepted() const;
};

/// `x` was rendered with `spp` samples a pixel. `variance` is the variance of one sample in XYZ, converted to linear
/// RGB, so that it may have negative values. The reference counts as exact. Throws std::invalid_argument if the
/// images differ in size or are empty.
MitsubaZTest mitsuba_z_test(const Image& x, const Image& reference, const Image& variance, std::uint32_t spp);

}  // namespace gib
