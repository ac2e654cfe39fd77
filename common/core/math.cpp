#include "common/core/math.h"

namespace gib {

Frame frame_along(const Vec3& n, const Vec3& direction) {
    const Vec3 d = direction.stableNormalized(), across = d - n * n.dot(d);
    // If `direction` is within 1e-6 rad of n, `across` is mostly rounding error, which also has a part along n.
    if (!(across.squaredNorm() > sqr(1e-6f))) return Frame(n);
    const Vec3 nearly = across.normalized(), s = (nearly - n * n.dot(nearly)).normalized();
    Frame frame;
    frame.n = n;
    frame.s = s;
    frame.t = n.cross(s);
    return frame;
}

}  // namespace gib
