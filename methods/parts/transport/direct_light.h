#pragma once
// Direct light at a point: the one function for every method.

#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"

namespace gib {

/// Whether the caller also finds lights by following its bsdf samples.
enum class LightTechniques {
    light_sampling_only,
    light_and_bsdf_sampling  ///< weighted by the power heuristic against the density of the bsdf or phase function
};

/// Where in a scene with media a vertex lies: what light crosses on its way is estimated with the numbers of `flights`.
struct Surroundings {
    const Medium* medium;  ///< in front of the surface as the path arrives; null: nothing
    NumberStream& flights;
};

/// One sample of the radiance [W/(sr m^2)] that the hit's non-delta lobes of the kinds `which` scatter towards wo
/// straight from a light: f(wo, wi) Le cos(theta_i) / pdf_w, times the weight of light sampling, by the kind of lobe.
/// Source: Veach 1997, sections 8.2 (three-point form) and 9.2 (combination).
/// For a scene without media.
LobeValues sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                               LightTechniques techniques, Lobes which = Lobes::all);
/// The same in a scene with media.
LobeValues sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                               const Surroundings& surroundings, LightTechniques techniques, Lobes which = Lobes::all);

/// One sample of the radiance [W/(sr m^2)] that a scattering event at p in `surroundings` sends towards wo straight
/// from a light: p(wo, wi) Le T / pdf_w, times the weight of light sampling against the phase function's.
Color sample_direct_light(RayQueries& rays, const Vec3& p, const Vec3& wo, const VertexNumbers& u,
                          const Surroundings& surroundings, LightTechniques techniques);

enum class ShadowRay {
    traced,
    skipped  ///< the light is known to be seen
};

/// The same for a light sample whose pdf_w has the choice of the light in it, by light sampling only. For a scene
/// without media.
LobeValues direct_light_of(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const LightSample& light,
                           ShadowRay shadow_ray, Lobes which = Lobes::all);

/// The same radiance, found by following a sample of the bsdf; with sample_direct_light's it makes up the whole. For
/// methods whose paths do not go on in that direction anyway.
LobeValues follow_to_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                           Lobes which = Lobes::all);

/// The weight of radiance that a bsdf's sample of density `pdf_w` from `previous` found on a light, against light
/// sampling from there; an infinite density: light sampling could not have found it.
float bsdf_sampling_weight(const Scene& scene, const Vec3& previous, float pdf_w, const SurfaceHit& hit);

/// The radiance [W/(sr m^2)] of the environment that a bsdf's sample of direction w found by leaving the scene, times
/// that weight.
Color escaped_radiance(const Scene& scene, const Vec3& previous, float pdf_w, const Vec3& w);

}  // namespace gib
