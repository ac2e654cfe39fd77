#pragma once
// The estimator of path tracing. Source: Kajiya 1986, "The Rendering Equation".

#include "common/images/film.h"
#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"

namespace gib {

struct PathSettings {
    int max_edges;        ///< edges of the longest path
    bool light_sampling;  ///< false where no light can be sampled from any surface
};

/// One sample of a pixel, by component: an unbiased estimate of the radiance [W/(sr m^2)] that arrives along the
/// camera's ray (Kajiya 1986).
PixelSample trace_path(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const PathSettings& settings);

}  // namespace gib
