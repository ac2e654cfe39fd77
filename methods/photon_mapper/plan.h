#pragma once
// The plan of the photon mapper: which of its passes run for a scene, and why the others are skipped.

#include "methods/method.h"
#include "methods/parts/photons/projection_map.h"
#include "methods/photon_mapper/settings.h"

#include <memory>
#include <string_view>

namespace gib {

inline constexpr std::string_view pass_specular = "specular paths";
inline constexpr std::string_view pass_caustic = "caustic map";
inline constexpr std::string_view pass_global = "global map";
inline constexpr std::string_view pass_volume = "volume map";
inline constexpr std::string_view pass_caustic_aim = "projection map of the caustic map";
inline constexpr std::string_view pass_global_aim = "projection map of the global map";
inline constexpr std::string_view pass_gather = "final gathering";
inline constexpr std::string_view pass_irradiance = "precomputed irradiance";
inline constexpr std::string_view pass_cache = "irradiance cache";

/// The plan for `effects`. A projection map that it runs is built at the start of the run. Only then is it known whether
/// the map drops any emission; otherwise photons leave the lights in all directions.
Plan photon_mapper_plan(const Scene& scene, const Effects& effects, const PhotonMapperSettings& settings);

/// The projection maps that aim the photons of each map; null where photons leave the lights in all directions.
struct Aims {
    std::unique_ptr<ProjectionMap> caustic, global;
};
/// Builds the projection maps that the plan runs and keeps those that drop emission.
Aims build_aims(const Plan& plan, const Scene& scene, const PhotonMapperSettings& settings);

}  // namespace gib
