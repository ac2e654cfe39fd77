#pragma once
// The corners of a radiosity solution's patches with their radiosity, for files and for display.

#include "methods/parts/stored_light/stored_light.h"
#include "methods/radiosity/model.h"

namespace gib {

/// B [W/m^2] of every corner, in the order of PatchVertices: at a leaf's corner, the reflectance of its patch times the
/// sum of the patch's direct irradiance and the indirect irradiance at the corner; at a corner that leaves share, the
/// mean over them, weighted by area.
std::vector<Colord> corner_radiosity(const RadiosityModel& model);
/// The place of a corner [scene units].
Vec3d corner_position(const RadiosityModel& model, const PatchVertex& corner);
/// The corners of a leaf, counter-clockwise as seen from the front of its side. The fourth of a triangle is unused.
std::array<std::uint32_t, 4> corners_in_turn(const RadiosityModel& model, std::uint32_t leaf);

/// All leaves of the mesh as display shows them.
StoredPatches stored_patches(const RadiosityModel& model);

}  // namespace gib
