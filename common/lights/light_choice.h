#pragma once
// The probabilities with which one of many lights is chosen for the start of a light path.

#include "common/lights/light.h"
#include "common/sampling/warp.h"

namespace gib {

/// Probabilities in proportion to power (mean of the channels), except that a tenth of the choices is uniform over
/// all lights that emit. Otherwise a dim light would be chosen too rarely where the bright ones do not reach, and
/// never if its probability is below the resolution of the random numbers.
DiscreteDistribution light_choice(const std::vector<Light>& lights);

}  // namespace gib
