#pragma once
// Direct light at a point: the one function for every method.

#include "common/sampler.h"
#include "methods/ray_queries.h"

namespace gib {

/// Whether the caller also finds lights by following its bsdf samples.
enum class LightTechniques {
    light_sampling_only,
    light_and_bsdf_sampling  ///< weighted by the power heuristic against the bsdf's density
};

/// One sample of the radiance [W/(sr m^2)] that the hit's non-delta lobes scatter towards wo straight from a light:
/// f(wo, wi) Le cos(theta_i) / pdf_w, times the weight of light sampling.
/// Source: Veach 1997, sections 8.2 (three-point form) and 9.2 (combination).
Color sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const Sampler& sampler,
                          int vertex, LightTechniques techniques);

}  // namespace gib
