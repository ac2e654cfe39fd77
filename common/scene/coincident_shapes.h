#pragma once
// Surfaces in the same place, where a ray can meet only one of them, and where that would make an image wrong.

#include "common/core/error.h"
#include "common/scene/scene.h"

#include <span>

namespace gib {

/// Throws InputError, at the later of the two places, for
/// - two lamps: points of both are chosen as lights, and a ray that finds a lamp finds one of them; the weights with
///   which these are combined then belong to neither;
/// - a lamp and another surface, but where two meshes touch: its points are chosen, but rays find it or not, as they
/// are rounded;
/// - two boundaries of media or of refracting materials that differ in their indices, dispersion or media, or in where
///   their fronts are, as those of two cubes that touch: a path would cross the one and not the other, and be in the
///   wrong medium or multiply radiance by the square of the ratio of the wrong indices from there on.
/// Only what is exactly in the same place, triangle by triangle, is found. `where`: of each object.
void refuse_coincident_shapes(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                              std::span<const SourceLocation> where);

/// Lifts each flat lamp (a rectangle, a disk, a mesh in one plane) in whose plane another surface lies, the ceiling
/// that it is let into say, off that to its front, by twice what both may be rounded: rays then find the lamp. Not off
/// other lamps, nor off what lets light through.
void lift_lamps_off_surfaces(std::span<SceneParts::Object> objects, std::span<const Material> materials);

}  // namespace gib
