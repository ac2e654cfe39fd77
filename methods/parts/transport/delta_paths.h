#pragma once
// Which paths cannot be made, or are made by chance only. A point, spot or directional light that is seen through mirrors or
// smooth interfaces alone is found by no connection. A pencil of light, thin as a laser's, lights so little of the scene that a
// path from the camera hardly ever ends there; paths from the lights always do.

#include "methods/method.h"

namespace gib {

/// Adds components that the method does not sample to Plan::unresolved, each once.
void leave_out(Plan& plan, const std::vector<Component>& components);

/// Whether the scene has a mirror or a smooth interface.
bool has_delta_lobe(const Scene& scene);

/// The components that hold paths from a point, spot or directional light L to a diffuse surface over delta lobes S, D S+
/// L, whether these paths are caustics or the ends of longer paths.
std::vector<Component> components_of_delta_paths(const Scene& scene, const Effects& called_for);

/// The components in `lit` whose paths `called_for` holds, if the scene has a pencil of light, else none. A pencil is a
/// spot or projector that shines into less than 1e-6 sr. In a scene of the size D it lights less than 1e-6 D^2, where
/// about one of 1e6 paths from the camera ends.
std::vector<Component> components_of_pencils(const Scene& scene, const Effects& called_for,
                                             const std::vector<Component>& lit);

/// The components of pencils that are seen through mirrors or smooth interfaces, which paths from both ends do not join.
std::vector<Component> components_of_mirrored_pencils(const Scene& scene, const Effects& called_for);

/// Has the plan leave out what paths from the camera alone do not find: light of pencils and delta paths. Where these are
/// all caustics of the scene, the effect is missing.
void leave_out_of_camera_paths(Plan& plan, const Scene& scene);

}  // namespace gib
