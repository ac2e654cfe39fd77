#pragma once
// Tests whether images lack light that the reference has, for methods that declare themselves unbiased and whose
// samples start at the camera. energy_test.cpp has the derivation.

#include "experiments/metrics/energy_balance.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gib {

/// The significance level of all tests of a table together.
inline constexpr double energy_alpha = 0.01;

/// The samples behind the images of a method.
struct SampledLight {
    std::uint32_t passes = 1;  ///< samples a pixel of each image, at least
    /// Largest radiance that a light path can find by chance, mean of the channels [W/(sr m^2)]; empty: no bound is
    /// known.
    std::optional<double> brightest = {};
};

/// The energy that images lack.
struct EnergyTest {
    Estimate excess;           ///< EnergyBalance::excess with an interval that the test's level gives
    bool is_rejected = false;  ///< light is missing: significantly, and at least balance_least
};

/// Tests `images` of a method whose samples light their own pixels alone. `alpha`: significance level; `unsampled`: the
/// part of the reference's mean energy that lies where all images are black (analysis/unsampled_light.h) [W/(sr m^2)].
/// Empty below two images, without a bound of `sampled.brightest`, without noise in the images or a known one in the
/// reference, and if a value is not finite.
std::optional<EnergyTest> energy_test(const std::vector<Image>& images, const SampledLight& sampled,
                                      const ReferenceLayer& reference, const EnergyBalance& balance, double unsampled,
                                      double alpha);

}  // namespace gib
