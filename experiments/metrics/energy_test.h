#pragma once
// Tests whether the mean energy of the images of a method that has no bias by its declaration is that of the reference.
// energy_test.cpp has the derivation.

#include "experiments/metrics/equal_footing.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gib {

/// The mean energy of one run's image after so many passes [W/(sr m^2)].
struct EnergyAfter {
    std::uint32_t passes;
    double energy;
};
/// The energies of one run in the order of its passes; those of the final image are the last.
using EnergyCurve = std::vector<EnergyAfter>;

/// The significance level of all tests of a table together.
inline constexpr double energy_alpha = 0.01;

/// Whether a mean energy differs from the reference's.
struct EnergyTest {
    /// Footing::excess with a 99 % interval by the scatter of seeds and passes; its upper end allows for the light that no image has
    /// met.
    Estimate excess;
    bool is_rejected = false;  ///< the energies differ significantly, by footing_least or more
};

/// Tests `images`, the final images of one curve each, against the reference's layer; `alpha`: significance level of this test; `unmet`: the part of the
/// reference's mean energy that lies where all images are black (analysis/unmet_light.h). Empty below two images, without
/// noise in the images or a known one in the reference, and if a value is not finite.
std::optional<EnergyTest> energy_test(const std::vector<EnergyCurve>& curves, const std::vector<Image>& images,
                                      const ReferenceLayer& reference, const Footing& footing, double unmet,
                                      double alpha);

}  // namespace gib
