#pragma once
// Surfaces in exactly the same place where a ray can meet only one, and where that makes an image wrong.

#include "common/error.h"
#include "common/scene.h"

#include <span>

namespace gib {

/// Throws InputError, at the later of the two places, for
/// - two lamps: points of both are chosen as lights, and a ray that finds a lamp finds one of them; the weights with
///   which these are combined then belong to neither;
/// - a lamp and another surface that comes before it: its points are chosen, but rays never find it;
/// - two interfaces of refracting materials of different indices or dispersion: a path would cross the one and not the
///   other, and radiance is multiplied by the square of the ratio of the wrong indices.
/// Everything else that coincides has a defined result: the shape that comes first in the file is seen.
/// `where`: of each object.
void refuse_coincident_shapes(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                              std::span<const SourceLocation> where);

}  // namespace gib
