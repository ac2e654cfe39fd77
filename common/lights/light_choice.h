#pragma once
// With what probability one of many lights is chosen where nothing is known of which of them are seen.

#include "common/lights/light.h"
#include "common/sampling/warp.h"

namespace gib {

/// Proportional to power (mean of the channels), but a tenth of the choices goes to all lights alike: what a dim
/// light adds where the bright ones do not reach would otherwise be found too rarely, and never at all below the
/// resolution of the random numbers.
DiscreteDistribution light_choice(const std::vector<Light>& lights);

}  // namespace gib
