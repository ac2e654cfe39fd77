#pragma once
// The path tracer's estimator, apart from its Run, so that a benchmark can replay its rays.

#include "common/film.h"
#include "common/sampler.h"
#include "methods/ray_queries.h"

namespace gib {

struct PathLimits {
    int max_edges;        ///< edges of the longest path
    bool light_sampling;  ///< off where no light can be sampled from any surface
};

/// One sample of a pixel by component: an unbiased estimate of the radiance [W/(sr m^2)] that arrives along `ray`.
PixelSample trace_path(RayQueries& rays, Ray ray, const Sampler& sampler, const PathLimits& limits);

}  // namespace gib
