#pragma once
// Features of the first surface that each pixel sees, for filters.

#include "common/images/non_local_means.h"
#include "methods/method.h"

#include <array>
#include <cstdint>

namespace gib {

/// The name, in stages, of the time that features take.
inline constexpr std::string_view step_features = "features";

/// Features as means over the camera's rays of `passes` passes, an even number: the first and the second half of them apart. The rays
/// are those of `path` in its first passes, so that features have the image's pixel filter, lens and borders. Mirrors and
/// glass are surfaces like any other: what is seen in them has no features.
std::array<FeatureImages, 2> first_surface_features(const Scene& scene, std::uint64_t seed, std::uint32_t passes,
                                                    StageTimes& stages);
/// The mean of both halves.
FeatureImages mean_of(const std::array<FeatureImages, 2>& halves);

}  // namespace gib
