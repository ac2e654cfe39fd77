#pragma once
// Contacts are places where a surface stands on a patch. A patch has one radiosity, but its part under a box is dark
// and exchanges light with the inside of the box only. Without more halvings both parts would send out the mean of
// both, and what the covered part sends would be lost. Patches are therefore halved along contacts, and covered points
// are left out of the smallest of them (light.cpp).

#include "methods/radiosity/mesh.h"

namespace gib {

/// Whether a ray just above the surface meets nothing between two points of a side of a flat chart. `reach` is the
/// size of the patch there [scene units], to which the ray's height is in proportion.
bool way_is_clear(RayQueries& rays, const SurfacePoint& from, const SurfacePoint& to, double reach);

/// Halves the leaves that something stands on, as long as their radius is above `least` [scene units]. Adds the rays
/// traced to `rays`.
void halve_at_contacts(PatchMesh& mesh, double least, std::uint64_t& rays);

}  // namespace gib
