#pragma once
// Direct light: estimates of the light that reaches a point straight from a light. All methods share these functions.

#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"

namespace gib {

/// How the caller finds lights; it decides the weight of a light sample.
enum class LightTechniques {
    light_sampling_only,     ///< weight 1
    light_and_bsdf_sampling  ///< the caller also follows its bsdf or phase samples: power heuristic
};

/// The medium around a vertex. `flights` gives the random numbers for estimating how much light the media on the way
/// let through.
struct Surroundings {
    const Medium* medium;  ///< medium that the path arrives in; null: vacuum
    NumberStream& flights;
};

/// One sample of the radiance [W/(sr m^2)] that the hit's non-delta lobes of the kinds `which` scatter towards wo
/// straight from a light, by kind of lobe: f(wo, wi) Le V cos(theta_i) / pdf_w, times the weight of light sampling. In
/// a scene with media the transmittance along the way takes the place of the visibility V.
/// Source: Veach 1997, chapter 8 (three-point form) and section 9.2 (combination).
LobeValues sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                               const Surroundings& surroundings, LightTechniques techniques, Lobes which = Lobes::all);

/// One sample of the radiance [W/(sr m^2)] that a scattering event at p in `surroundings` sends towards wo straight
/// from a light: p(wo, wi) Le T / pdf_w, where T is the transmittance, times the weight of
/// light sampling against phase sampling.
Color sample_direct_light(RayQueries& rays, const Vec3& p, const Vec3& wo, const VertexNumbers& u,
                          const Surroundings& surroundings, LightTechniques techniques);

/// The radiance of sample_direct_light for a given light sample, by light sampling only. The caller has included the
/// probability of choosing the light in `light.pdf_w`. For a scene without media.
LobeValues direct_light_of(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const LightSample& light,
                           Lobes which = Lobes::all);

/// One sample of the same radiance, found by following a sample of the bsdf; its sum with sample_direct_light
/// (light_and_bsdf_sampling) is an unbiased estimate. For methods whose paths do not go on in that direction.
LobeValues follow_to_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                           Lobes which = Lobes::all);

/// Weight, against light sampling from `previous`, of emitted radiance that a bsdf sample of density `pdf_w` [1/sr]
/// from there has found at `hit`. An infinite density gives weight 1: light sampling could not have found it.
float bsdf_sampling_weight(const Scene& scene, const LitPoint& previous, float pdf_w, const SurfaceHit& hit);

/// Radiance [W/(sr m^2)] of the environment that a bsdf sample of direction w has found by leaving the scene, times
/// its weight against light sampling from `previous`.
Color escaped_radiance(const Scene& scene, const LitPoint& previous, float pdf_w, const Vec3& w);

}  // namespace gib
