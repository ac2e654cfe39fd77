#pragma once
// The radius of look-ups by place: that of the whole image, but no larger than what lies there.
//
// On a body smaller than the disc every radius finds the same photons. The estimate is then wrong by the ratio of two areas,
// and its difference to the estimate from a smaller radius says nothing about this bias. So the radius is halved until the
// surface reaches as far. The triangle of the hit may reach as far by itself. If not, probes at this distance in eight
// directions look for surface near the tangent plane whose normal agrees (surface_disc.h), and three have to find some. At a
// straight edge four do, and the area of the disc is cut there (SurfaceDisc::covered()). On a thin rod two do, along its axis;
// on a ball all do up to 0.8 of its radius.
//
// The radius depends on the place alone, without random numbers, so that look-ups of all passes shrink from the same one.

#include "methods/parts/transport/ray_queries.h"

namespace gib {

/// The radius at `hit` for light on the side of wo, as a share of `largest`, the radius on large surfaces [scene
/// units]: 1, 1/2, 1/4, ... down to 2^-12.
float share_of_radius_at(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, float largest);

}  // namespace gib
