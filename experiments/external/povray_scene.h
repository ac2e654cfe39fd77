#pragma once
// Writes a scene in the language of POV-Ray 3.7.
//
// It can express meshes and spheres that are diffuse, smooth glass or a perfect mirror; lamps on parallelograms; point
// lights; the perspective pinhole camera; a box filter of one pixel. Anything else is an error at its place in the file.
//
// | quantity | POV-Ray | meaning |
// |---|---|---|
// | d | | distance from the light to the lit point [scene units] |
// | d0 | fade_distance | a thousandth of the scene's diagonal [scene units] |
// | C | color of a light_source | radiance of a white surface at d0 under cos = 1 [W/(sr m^2)] |
//
// Units. A diffuse surface of reflectance rho shows rho C cos(theta) 2 / (1 + (d / d0)^2) in POV-Ray (manual 3.7, "Light
// Fading", with fade_power 2; its diffuse finish has no 1 / pi), which is rho C cos(theta) 2 d0^2 / d^2 but for a share of
// (d0 / d)^2. A lamp of radiance Le and area A gives rho / pi Le A cos(theta) cos(theta') / d^2. With the factor
// cos(theta') from a spotlight of tightness 1, both agree for C = Le A / (2 pi d0^2); for a point light of intensity I, C =
// I / (2 pi d0^2). Radiance is then the same number on both sides, also in the radiosity of POV-Ray, whose estimate of
// the diffuse light is rho times the mean radiance over a cosine-weighted hemisphere.
//
// Conventions that differ and are not adapted: surfaces reflect on both sides, a lamp casts no shadow, and
// paths end by POV-Ray's own limits instead of `max_depth`.
//
// The command chooses the method by Declare=NAME=VALUE: `Radiosity` rays of each record of its irradiance cache, with
// `RadiosityError` as its error_bound (default 0.5); `Photons` aimed at glass and mirrors; `LampPoints` shadow rays along
// each edge of a lamp (default 4), jittered.

#include "common/core/error.h"
#include "common/reader/scene_file.h"

#include <string>
#include <vector>

namespace gib {

/// The scene as the text of a .pov file. Its file is read again, with the same options, for the places of its parts. Throws
/// InputError, at its place, for what POV-Ray's form cannot express.
std::string povray_scene(const LoadedScene& loaded, const std::string& file, const SceneLoadOptions& options);

}  // namespace gib
