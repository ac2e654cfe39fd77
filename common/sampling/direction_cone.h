#pragma once
// Cones that bound sets of directions.

#include "common/core/math.h"

namespace gib {

/// Rounding error [rad] of a direction in float.
inline constexpr double direction_rounding = 4e-6;

/// All unit vectors within `half_angle` [rad] of the unit vector `axis`; all directions if half_angle >= pi.
struct DirectionCone {
    Vec3d axis = Vec3d(0, 0, 1);
    double half_angle = std::numbers::pi;
};

/// The directions whose angle to a frame's n lies in [theta0, theta1], a part of [0, pi], and whose azimuth from s
/// towards t lies in [phi0, phi1]. All angles are in rad.
struct SphericalPatch {
    double theta0, theta1, phi0, phi1;
};

/// A cone that holds the patch. Its half angle is enlarged by the rounding error of directions in float.
DirectionCone cone_around(const SphericalPatch& patch, const Frame& axes);

/// The patch to which square_to_sphere() maps the box [lower, upper] of [0, 1]^2, enlarged by the rounding
/// error of z.
SphericalPatch square_to_sphere_patch(const Vec2& lower, const Vec2& upper);

}  // namespace gib
