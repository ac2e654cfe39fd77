#pragma once
// Shared by the methods of light paths: how many paths there are, how they start, and the units of their light.

#include "methods/method.h"
#include "methods/parts/emission/light_emission.h"
#include "methods/parts/transport/light_policy.h"

namespace gib {

inline constexpr std::string_view step_light_paths = "light paths";
inline constexpr std::string_view step_light_aim = "projection map of the light paths";
inline constexpr std::string_view step_connections = "connections";

/// The light paths of a scene's pass: as many as pixels.
struct LightPaths {
    /// Builds the projection map if the plan runs it and there is no policy that has starts of its own.
    LightPaths(const Scene& scene, const Plan& plan, StageTimes& stages,
               std::shared_ptr<const LightPolicy> by = nullptr);

    double count;                               ///< number of light paths in a pass
    double power;                               ///< emitted by the scene [W], the unit of the paths' power
    bool camera_on_surface;                     ///< RayQueries::camera_lies_on_surface()
    std::shared_ptr<const LightPolicy> policy;  ///< null without one
    LightEmission emission;
    /// A power of 2 near 1000 times the radiance [W/(sr m^2)] that this power makes in the whole scene: the unit of sums
    /// over pixels, times `count`. Most additions are smaller, and leave the sums' whole numbers alone.
    double sum_unit;
};

/// Adds the steps of the light paths, which are skipped where they cannot be seen: nothing emits, or paths of two edges
/// are longer than allowed.
void add_light_paths(Plan& plan, const Scene& scene, int max_edges);

}  // namespace gib
