#pragma once
// The test by which Mitsuba 3 judges its own renderings (its src/render/tests/test_renders.py): every pixel against a
// converged reference, with the variance of one sample that was stored with the reference.

#include "common/images/image.h"

#include <cstddef>
#include <cstdint>

namespace gib {

struct MitsubaZTest {
    static constexpr double significance = 0.01;
    static constexpr double least_share = 0.9975;  ///< of the values have to pass

    std::size_t values = 0;     ///< pixels x 3 (X, Y and Z)
    std::size_t passing = 0;    ///< whose p is above `threshold`
    std::size_t nonfinite = 0;  ///< of the values' statistics; they do not pass
    double threshold = 0;       ///< 0.01 `significance` with Sidak's correction for the number of pixels
    double smallest_p = 1;
    int x = 0, y = 0;         ///< where it is [pixels], row 0 on top
    std::size_t channel = 0;  ///< X, Y, Z
    double share() const { return static_cast<double>(passing) / static_cast<double>(values); }
    bool accepted() const;
};

/// `x` was rendered with `spp` samples a pixel; `variance` is that of one sample, a linear RGB image that was XYZ (so
/// that negative values are right). The reference counts as exact. All of one size, not empty.
MitsubaZTest mitsuba_z_test(const Image& x, const Image& reference, const Image& variance, std::uint32_t spp);

}  // namespace gib
