#pragma once
// Reads the <medium> elements of a scene file, with the volumes and the phase function in them.

#include "common/media/medium.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Reads a medium: homogeneous (sigma_t and albedo, or sigma_s and sigma_a) or heterogeneous (sigma_t and albedo,
/// each a number, a colour or a <volume>), both with `scale` and a phase function, isotropic or hg. `origin` is the
/// scene's origin in the file's coordinates. Throws InputError.
Medium parse_medium(const NestedObject& object, TextureFiles& files, const Vec3d& origin);

}  // namespace gib
