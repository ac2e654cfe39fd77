#pragma once
// The path tracer's estimator, apart from its Run, so that a benchmark can replay its rays.

#include "common/images/film.h"
#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"

namespace gib {

/// What a scene's surfaces need besides ideal diffuse and delta lobes; the estimator is compiled for each combination.
struct PathFeatures {
    bool holes;                ///< masks
    bool glossy;               ///< lobes that are no delta and yet count as specular
    bool media_or_dispersion;  ///< few scenes have either: one variant has both
};
PathFeatures features_of(const Scene& scene);

struct PathSettings {
    int max_edges;        ///< edges of the longest path
    bool light_sampling;  ///< off where no light can be sampled from any surface
    PathFeatures features;
};

/// One sample of a pixel by component: an unbiased estimate of the radiance [W/(sr m^2)] that arrives along the
/// camera's ray.
PixelSample trace_path(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const PathSettings& settings);

}  // namespace gib
