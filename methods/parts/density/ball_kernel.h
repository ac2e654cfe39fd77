#pragma once
// Kernels over a ball, for look-ups in media, and the share of the ball that no surface hides from its centre.

#include "common/sampling/sampler.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/transport/ray_queries.h"

namespace gib {

/// K(d) [1/volume] for d^2 = `d2` <= r^2, r > 0; integrates to 1 over the ball of radius r. In double: 1 / r^3
/// exceeds the range of float below r = 1e-13.
double ball_kernel_weight(Kernel kernel, float d2, float r);
/// The distance, as a fraction of r, below which the share `u` of the kernel's integral over the ball lies.
float ball_kernel_radius(Kernel kernel, float u);

/// An unbiased estimate of 1 / phi, where phi is the share of the kernel's ball of radius r around p that no surface
/// hides from p. Independent points of the ball are probed until m of them are visible, and the estimate is the number
/// of probes over m. That number is a negative binomial variable of mean m / phi; the reciprocal of a share found by n
/// probes would be too large by (1 - phi) / (n phi), which is 12 % where half of the ball is hidden and n = 8.
float reciprocal_share_in_sight(Kernel kernel, RayQueries& rays, const Vec3& p, float r, NumberStream& u);

}  // namespace gib
