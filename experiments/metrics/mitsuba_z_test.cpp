#include "experiments/metrics/mitsuba_z_test.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gib {

namespace {

constexpr float least_variance = 1e-4f;

/// CIE XYZ from linear RGB with the primaries of ITU-R BT.709. The coefficients are those with which Mitsuba converts
/// its files.
Color xyz_from_rgb(const Color& c) {
    return {0.412453f * c[0] + 0.357580f * c[1] + 0.180423f * c[2],
            0.212671f * c[0] + 0.715160f * c[1] + 0.072169f * c[2],
            0.019334f * c[0] + 0.119193f * c[1] + 0.950227f * c[2]};
}

/// P(|Z| >= z) by way of 1 - Phi(z) in float, as Mitsuba computes it: p is a multiple of 2^-23, and 0 above z = 5.35.
/// In images of more than 112000 pixels, values above z = 5.35 may therefore fail although their exact p is above the
/// threshold. Only float reproduces the decision of Mitsuba.
float two_sided_p(float z) {
    const float below = (1 - std::erf(-z / std::numbers::sqrt2_v<float>)) * 0.5f;
    return 2 * (1 - below);
}

}  // namespace

bool MitsubaZTest::accepted() const {
    return static_cast<double>(passing) / 3 >= least_share * (static_cast<double>(values) / 3);
}

MitsubaZTest mitsuba_z_test(const Image& x, const Image& reference, const Image& variance, std::uint32_t spp) {
    if (!x.same_size(reference) || !variance.same_size(reference) || x.pixels() == 0)
        throw std::invalid_argument("mitsuba_z_test: images of different sizes, or empty ones");
    MitsubaZTest result;
    result.values = 3 * x.pixels();
    // Mitsuba corrects for the number of pixels, although three times as many values are tested.
    result.threshold = -std::expm1(std::log1p(-MitsubaZTest::significance) / static_cast<double>(x.pixels()));
    const auto threshold = static_cast<float>(result.threshold), samples = static_cast<float>(spp);
    for (std::size_t pixel = 0; pixel < x.pixels(); ++pixel) {
        const Color mean = xyz_from_rgb(x.at(pixel)), exact = xyz_from_rgb(reference.at(pixel));
        const Color sample_variance = xyz_from_rgb(variance.at(pixel));
        for (int k = 0; k < 3; ++k) {
            // NaN stays NaN, as with NumPy's maximum.
            const float v = std::isless(sample_variance[k], least_variance) ? least_variance : sample_variance[k];
            const float p = two_sided_p(std::abs(mean[k] - exact[k]) * std::sqrt(samples / v));
            if (!std::isfinite(p) || !std::isfinite(mean[k])) ++result.nonfinite;
            if (std::isnan(p)) continue;
            if (p > threshold) ++result.passing;
            if (static_cast<double>(p) < result.smallest_p) {
                result.smallest_p = static_cast<double>(p);
                result.x = static_cast<int>(pixel % static_cast<std::size_t>(x.width));
                result.y = static_cast<int>(pixel / static_cast<std::size_t>(x.width));
                result.channel = static_cast<std::size_t>(k);
            }
        }
    }
    return result;
}

}  // namespace gib
