#pragma once
// Finds surfaces in the same place, of which a ray can meet only one, and refuses those that would make
// an image wrong.

#include "common/core/error.h"
#include "common/scene/scene.h"

#include <span>

namespace gib {

/// Throws InputError at the later of the two places in the file for
/// - two lamps: points of both are sampled, but a ray that hits a lamp finds only one of them, so that the weights
///   which combine both techniques belong to neither;
/// - a lamp and another surface, unless it is a mesh whose front faces the other way, as where two bodies touch: the
///   lamp's points are sampled, but rounding decides whether a ray finds them;
/// - two boundaries of media or of refracting materials that differ in their indices, dispersion or media, or whose
///   fronts face opposite ways, as those of two touching cubes do: a path would cross only one of them and from there
///   on be in the wrong medium, or multiply radiance by the square of the wrong ratio of indices.
/// Only surfaces in exactly the same place, triangle by triangle, are found. `where` holds the place of each object
/// in the file.
void refuse_coincident_shapes(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                              std::span<const SourceLocation> where);

/// Lifts each flat lamp (a rectangle, a disk, a mesh in one plane) that lies in the plane of another surface, such as
/// the ceiling that holds it. The lamp moves to its front by twice the rounding error of both places, so that rays
/// find it. Other lamps, and surfaces that let light through, do not count.
void lift_lamps_off_surfaces(std::span<SceneParts::Object> objects, std::span<const Material> materials);

}  // namespace gib
