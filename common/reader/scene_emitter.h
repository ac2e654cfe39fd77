#pragma once
// Reads the <emitter> elements of a scene file.

#include "common/lights/light.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Reads the radiance of an `area` emitter, which stands in a shape. Throws InputError.
Texture parse_area_emitter(const NestedObject& emitter, TextureFiles& files);

/// Reads an emitter: point (position or to_world, intensity), spot (to_world, intensity, cutoff_angle, beam_width,
/// texture), projector (to_world, irradiance, scale, a perspective's field of view), collimated (to_world, power), directional (direction or
/// to_world, irradiance), constant (radiance), envmap (filename, scale, to_world), sunsky, sky or sun
/// (scene_daylight.h). It is one light, but for a sky with a sun of parallel light. Positions are moved by -origin.
/// Sampling weights are checked but have no effect, because lights are chosen by their power. Throws InputError.
std::vector<Light> parse_emitter(const NestedObject& emitter, TextureFiles& files, const Vec3d& origin);

}  // namespace gib
