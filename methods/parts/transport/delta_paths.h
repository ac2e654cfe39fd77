#pragma once
// Which paths cannot be made by connections: those on which a point, spot or directional light is seen through mirrors or
// smooth interfaces alone.

#include "methods/method.h"

namespace gib {

/// Whether the scene has a mirror or a smooth interface.
bool has_delta_lobe(const Scene& scene);

/// The components that hold paths from a point, spot or directional light L to a diffuse surface over delta lobes S, D S+
/// L, whether these paths are caustics or the ends of longer paths.
std::vector<Component> components_of_delta_paths(const Scene& scene, const Effects& called_for);

}  // namespace gib
