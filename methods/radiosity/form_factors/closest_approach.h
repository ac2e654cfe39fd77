#pragma once
// The closest points of two segments.

#include "common/core/math.h"

#include <algorithm>

namespace gib {

struct ClosestApproach {
    double s;  ///< the point on the first segment, as a share of its length, in [0, 1]
    double distance;
};

/// The closest approach of the segments a b and c d, which may be points. Source: Ericson 2005, "Real-Time Collision
/// Detection", section 5.1.9.
inline ClosestApproach closest_approach(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const Vec3d u = b - a, v = d - c, w = a - c;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
    const auto ratio = [](double x, double y) { return y > 0 ? std::clamp(x / y, 0.0, 1.0) : 0.0; };
    double s = ratio(uv * vw - vv * uw, uu * vv - uv * uv);
    const double t = ratio(s * uv + vw, vv);
    s = ratio(t * uv - uw, uu);
    return {s, (w + s * u - t * v).norm()};
}

}  // namespace gib
