#pragma once
// Scattered rays: samples of a surface's Bsdf that lead no light through a closed surface,
// whatever its shading normals are.
//
// The shading normal and the geometric normal disagree about the side on which some directions lie. There a
// reflection would leave on the back of the surface, and a refraction would return to the side that it came from
// (Veach 1997, section 5.3). So diffuse and glossy lobes scatter nothing if the normals disagree about wi or wo, in
// both directions of transport. A mirror or a smooth interface has no other direction to send the light to; it
// scatters about the geometric normal there.

#include "common/scene/scene.h"

#include <array>
#include <optional>

namespace gib {

struct ScatteredRay {
    Vec3 wi;       ///< unit
    Color weight;  ///< f |cos| / pdf_w; from both_ways(): f |cos|, not divided by the probability of the lobe
    float pdf_w;   ///< [1/sr]; for a delta lobe the probability of choosing it
    bool delta;
    LobeKind lobe;
    float eta;    ///< index of refraction on wi's side over that on wo's side; 1 without refraction
    Vec3 normal;  ///< the normal that it was scattered about
};

namespace detail {

/// Turns a Bsdf sample into a ray in world space. `wo` is in the shading frame; the weight is divided by
/// `probability`. Empty if the normals forbid the direction and the lobe has no other.
inline std::optional<ScatteredRay> scattered_ray(const SurfaceHit& hit, const Vec3& wo, const BsdfSample& sample,
                                                 float probability, Transport transport) {
    ScatteredRay ray{.wi = hit.shading.to_world(sample.wi),
                     .weight = sample.f * (std::abs(sample.wi.z()) / probability),
                     .pdf_w = sample.pdf_w,
                     .delta = sample.delta,
                     .lobe = sample.lobe,
                     .eta = sample.eta,
                     .normal = hit.ns};
    if (!sample.delta && hit.delta_only) return std::nullopt;
    if (hit.normals_agree_about(ray.wi)) return ray;
    // The sample belongs to a bump-mapped normal, so no direction about the geometric normal can take its place.
    if (!sample.delta || hit.bsdf->is_tilted()) return std::nullopt;
    const Vec3 out = hit.shading.to_world(wo);
    const float cosine = out.dot(hit.ng), cos_o = std::abs(cosine);
    const Vec3 n = cosine >= 0.f ? hit.ng : Vec3(-hit.ng);
    ray.normal = n;
    const float sin2_t = (1.f - sqr(cos_o)) / sqr(sample.eta);
    if (wo.z() * sample.wi.z() < 0.f && sin2_t < 1.f) {
        ray.wi = (cos_o * n - out) / sample.eta - std::sqrt(1.f - sin2_t) * n;
        return ray;
    }
    ray.wi = 2.f * cos_o * n - out;
    if (transport == Transport::radiance) ray.weight *= sqr(sample.eta);  // the ray does not pass the interface
    ray.eta = 1.f;
    return ray;
}

}  // namespace detail

/// One ray by a sample of the Bsdf (Bsdf::sample_local()). Empty if nothing is scattered.
inline std::optional<ScatteredRay> sample_scattering(const SurfaceHit& hit, const Vec3& wo_local, const Vec2& u_lobe,
                                                     const Vec2& u, Transport transport, Lobes which = Lobes::all) {
    const auto sample = hit.bsdf->sample_local(wo_local, u_lobe, u, transport, which);
    return sample ? detail::scattered_ray(hit, wo_local, *sample, sample->pdf_w, transport) : std::nullopt;
}

/// The reflected and the refracted ray of a smooth interface (Bsdf::delta_pair_local()). Empty if there are not two.
inline std::optional<std::array<ScatteredRay, 2>> both_ways(const SurfaceHit& hit, const Vec3& wo_local,
                                                            Transport transport) {
    const auto lobes = hit.bsdf->delta_pair_local(wo_local, transport);
    if (!lobes) return std::nullopt;
    const auto first = detail::scattered_ray(hit, wo_local, (*lobes)[0], 1.f, transport),
               second = detail::scattered_ray(hit, wo_local, (*lobes)[1], 1.f, transport);
    return first && second ? std::optional(std::array{*first, *second}) : std::nullopt;
}

}  // namespace gib
