#pragma once
// The rounding error of positions in a scene.

#include "common/scene/scene.h"

namespace gib {

/// Bound of the rounding error of the position p in any direction [scene units]: p is a sum of numbers as large
/// as the scene. (SurfacePoint::offset is smaller on planes along the axes, because it bounds only the error
/// along the normal.)
inline float place_rounding(const Scene& scene, const Vec3& p) {
    return 4.f * unit_roundoff * (p.cwiseAbs().maxCoeff() + scene.diagonal());
}

}  // namespace gib
