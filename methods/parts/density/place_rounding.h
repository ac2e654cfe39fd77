#pragma once
// How well a place in a scene is known.

#include "common/scene/scene.h"

namespace gib {

/// How far a place may be off by rounding, in any direction [scene units]: it is a sum of numbers as large as the
/// scene. (A hit's own offset is less on planes along the axes: it bounds the error along the normal.)
inline float place_rounding(const Scene& scene, const Vec3& p) {
    return 4.f * unit_roundoff * (p.cwiseAbs().maxCoeff() + scene.diagonal());
}

}  // namespace gib
