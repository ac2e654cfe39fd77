#pragma once
// Reads the <medium> elements of a scene file, with the volumes and the phase function in them.

#include "common/media/medium.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Reads a medium: homogeneous (sigma_t and albedo, or sigma_s and sigma_a) or heterogeneous (sigma_t and albedo), both
/// with `scale` and a phase function, isotropic or hg. The albedo and a heterogeneous sigma_t are a number, a colour or a
/// <volume>. As in Mitsuba 3, every volume is a unit cube under its to_world, a number too, and a heterogeneous medium
/// ends at the cube of its sigma_t. `origin` is the scene's origin in the file's coordinates. Throws InputError.
Medium parse_medium(const NestedObject& object, TextureFiles& files, const Vec3d& origin);

}  // namespace gib
