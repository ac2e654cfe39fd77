#pragma once
// Which passes of the photon mapper a scene calls for.

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

/// Where the photons of each map are aimed; null: everywhere.
struct Aims {
    std::unique_ptr<ProjectionMap> caustic, global;
};

/// Builds the projection maps to find out what they can save.
Plan photon_mapper_plan(const Scene& scene, const Effects& effects, const PhotonMapperSettings& settings, Aims& aims);

}  // namespace gib
