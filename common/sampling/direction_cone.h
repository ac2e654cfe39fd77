#pragma once
// Cones around sets of directions.

#include "common/core/math.h"

namespace gib {

/// All unit vectors within `half_angle` [rad] of the unit vector `axis`; pi and more: all.
struct DirectionCone {
    Vec3d axis = Vec3d::UnitZ();
    double half_angle = std::numbers::pi;
};

/// The directions whose angle to a frame's n lies in [theta0, theta1], within [0, pi], and whose azimuth from s towards
/// t lies in [phi0, phi1]. [rad]
struct SphericalPatch {
    double theta0, theta1, phi0, phi1;
};

/// Holds the patch; the half angle is wider by what directions in float may be off.
DirectionCone cone_around(const SphericalPatch& patch, const Frame& axes);

/// The patch of square_to_sphere over a box of [0, 1]^2.
SphericalPatch square_to_sphere_patch(const Vec2& lower, const Vec2& upper);

}  // namespace gib
