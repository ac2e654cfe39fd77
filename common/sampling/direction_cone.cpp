#include "common/sampling/direction_cone.h"

#include <algorithm>

namespace gib {

namespace {

/// Bound of the rounding error of a direction [rad], which is a product of a few rounded floats.
constexpr double rounding = 4e-6;
/// Bound of the rounding error of the cosine z that square_to_sphere() computes in float.
constexpr double rounding_of_cosine = 3e-7;

Vec3d direction(double theta, double phi, const Frame& axes) {
    return std::sin(theta) * (std::cos(phi) * axes.s.cast<double>() + std::sin(phi) * axes.t.cast<double>()) +
           std::cos(theta) * axes.n.cast<double>();
}

}  // namespace

DirectionCone cone_around(const SphericalPatch& patch, const Frame& axes) {
    const Vec3d n = axes.n.cast<double>();
    DirectionCone cone = patch.theta1 <= std::numbers::pi - patch.theta0
                             ? DirectionCone{n, patch.theta1}
                             : DirectionCone{-n, std::numbers::pi - patch.theta0};
    // A cone around the patch's middle may be narrower than the one around a pole. For a fixed theta, the angle from
    // the middle grows with the difference in phi. For a fixed difference of up to a quarter turn, the cosine of that
    // angle is R cos(theta - theta*) with theta* in [0, pi], which is smallest at an end of [theta0, theta1]. The
    // half angle is therefore that of a corner.
    const double across = 0.5 * (patch.phi1 - patch.phi0), middle = 0.5 * (patch.theta0 + patch.theta1);
    if (across < 0.5 * std::numbers::pi) {
        double sine2 = 0;  // squared sine of half the angle: no cancellation for narrow patches
        for (const double theta : {patch.theta0, patch.theta1})
            sine2 = std::max(sine2, sqr(std::sin(0.5 * (middle - theta))) +
                                        std::sin(middle) * std::sin(theta) * sqr(std::sin(0.5 * across)));
        const double angle = 2 * std::asin(std::sqrt(std::min(sine2, 1.0)));
        if (angle < cone.half_angle) cone = {direction(middle, 0.5 * (patch.phi0 + patch.phi1), axes), angle};
    }
    cone.axis.normalize();  // the frame's vectors are rounded
    cone.half_angle += rounding;
    return cone;
}

SphericalPatch square_to_sphere_patch(const Vec2& lower, const Vec2& upper) {
    const auto theta = [](float u, double rounded) {
        return std::acos(std::clamp(1 - 2 * static_cast<double>(u) + rounded, -1.0, 1.0));
    };
    const double turn = 2 * std::numbers::pi;
    return {.theta0 = theta(lower.x(), rounding_of_cosine),
            .theta1 = theta(upper.x(), -rounding_of_cosine),
            .phi0 = turn * static_cast<double>(lower.y()),
            .phi1 = turn * static_cast<double>(upper.y())};
}

}  // namespace gib
