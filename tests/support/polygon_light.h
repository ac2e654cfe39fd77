#pragma once
// Light of a polygon in closed form.

#include "common/core/math.h"

#include <cmath>
#include <vector>

namespace gib::test {

/// Irradiance at `p` with the normal n from a polygon of radiance 1 by Lambert's formula, E = 1/2 sum of angle_i n .
/// gamma_i. Source: Arvo 1994, "The Irradiance Jacobian for Partially Occluded Polyhedral Sources", eq. 3.
inline double lambert_irradiance(const Vec3d& p, const Vec3d& n, const std::vector<Vec3d>& polygon) {
    double E = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d a = (polygon[i] - p).normalized(), b = (polygon[(i + 1) % polygon.size()] - p).normalized();
        E += 0.5 * std::acos(a.dot(b)) * n.dot(a.cross(b).normalized());
    }
    return std::abs(E);
}

}  // namespace gib::test
