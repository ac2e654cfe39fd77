#pragma once
// The axes in which a light that shines in all directions samples a direction.

#include "common/core/math.h"

namespace gib {

/// The coordinate axes, permuted cyclically so that the last one, the pole of square_to_sphere(), is the axis along
/// which `position` is smallest. Scenes lie around the origin (see SceneParts::origin), so that a distant light sees
/// them at most 36 degrees from the equator. At the pole a random number of 24 bits leaves a hole of 5e-4 rad, in
/// which a whole scene could lie.
inline Frame emission_axes(const Vec3& position) {
    const Vec3 far = position.cwiseAbs();
    Eigen::Index pole = 2;
    for (const Eigen::Index other : {0, 1})
        if (far[other] < far[pole]) pole = other;
    Frame axes;
    axes.n = Vec3::Unit(pole);
    axes.s = Vec3::Unit((pole + 1) % 3);
    axes.t = Vec3::Unit((pole + 2) % 3);
    return axes;
}

}  // namespace gib
