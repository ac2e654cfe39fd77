#pragma once
// Shared by the methods of light paths: how many paths there are, the units of their light, and which components of a
// scene have paths that they cannot make.

#include "methods/method.h"
#include "methods/parts/vertices/connections.h"

namespace gib {

inline constexpr std::string_view pass_light_paths = "light paths";
inline constexpr std::string_view pass_connections = "connections";

/// The light paths of a scene's pass: as many as pixels.
struct LightPaths {
    explicit LightPaths(const Scene& scene);

    double count;  ///< of a pass
    double power;  ///< emitted by the scene [W], the unit of the paths' power
    ToCamera camera;
    double mean_light;  ///< a power of 2 near the radiance [W/(sr m^2)] that this power makes in the whole scene: the
                        ///< unit of sums over pixels, times `count`
};

/// Whether the scene has a point, spot or directional light, and whether it has a mirror or a smooth interface.
bool has_delta_light(const Scene& scene);
bool has_delta_lobe(const Scene& scene);

/// Adds the step of the light paths, skipped where they cannot be seen: nothing emits, or paths of two edges are longer
/// than allowed.
void add_light_paths(Plan& plan, const Scene& scene, int max_edges);

}  // namespace gib
