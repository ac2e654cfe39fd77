#pragma once
// Where surfaces stand on patches. A patch has one value, but what is under a box is dark and sees nothing but the
// inside of the box: the mean light of both parts would be sent out from both, and what the covered part sends is
// lost. So patches are halved along such contacts; what is lost is of first order in the size of what is left.

#include "methods/radiosity/mesh.h"

namespace gib {

/// Whether nothing stands on the way between two places of a side of a flat chart, as seen from just over the surface.
/// `reach`: the size of the patch there [scene units].
bool way_is_clear(RayQueries& rays, const PatchMesh& mesh, const PatchSide& side, const Vec2d& from, const Vec2d& to,
                  double reach);

/// Halves the leaves that something stands on, each up to `halvings` times. Throws InputError beyond `most_nodes`.
void halve_at_contacts(PatchMesh& mesh, int halvings, std::size_t most_nodes, std::uint64_t& rays);

}  // namespace gib
