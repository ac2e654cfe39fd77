#pragma once
// Ways on from a surface: samples of its Bsdf that lead no light through a closed surface, whatever its shading normals
// are.
//
// A shading normal and the geometric normal disagree about the side on which some directions are. Where they do, a
// reflection would come out behind the surface, and a refraction on the side that it came from (Veach 1997, section
// 5.3). What is diffuse or glossy scatters nothing if they disagree about wi or wo, whichever way light is followed. A
// mirror or a smooth interface, which has no other direction to send the light to, sends it where the geometric normal
// says.

#include "common/scene/scene.h"

#include <array>
#include <optional>

namespace gib {

struct ScatteredRay {
    Vec3 wi;       ///< unit
    Color weight;  ///< f |cos| / pdf_w; both_ways() does not divide by the probability
    float pdf_w;   ///< [1/sr]; for a delta lobe the probability of choosing it
    bool delta;
    LobeKind lobe;
    float eta;    ///< index on wi's side over index on wo's side; 1 without refraction
    Vec3 normal;  ///< about which it was scattered
};

namespace detail {

/// `wo` is in the shading frame; `probability` divides the weight.
inline std::optional<ScatteredRay> scattered_ray(const SurfaceHit& hit, const Vec3& wo, const BsdfSample& sample,
                                                 float probability, Transport transport) {
    ScatteredRay ray{hit.shading.to_world(sample.wi),
                     sample.f * (std::abs(sample.wi.z()) / probability),
                     sample.pdf_w,
                     sample.delta,
                     sample.lobe,
                     sample.eta,
                     hit.ns};
    if (!sample.delta && hit.delta_only) return std::nullopt;
    if (hit.normals_agree_about(ray.wi)) return ray;
    // What a bump map makes of a normal belongs to the direction that is given up.
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
    if (transport == Transport::radiance) ray.weight *= sqr(sample.eta);  // it does not pass the interface
    ray.eta = 1.f;
    return ray;
}

}  // namespace detail

/// A sample of the Bsdf: see Bsdf::sample_local(). Empty where nothing is scattered.
inline std::optional<ScatteredRay> sample_scattering(const SurfaceHit& hit, const Vec3& wo_local, const Vec2& u_lobe,
                                                     const Vec2& u, Transport transport, Lobes which = Lobes::all) {
    const auto sample = hit.bsdf->sample_local(wo_local, u_lobe, u, transport, which);
    return sample ? detail::scattered_ray(hit, wo_local, *sample, sample->pdf_w, transport) : std::nullopt;
}

/// Both ways on from a smooth interface: see Bsdf::delta_pair_local().
inline std::optional<std::array<ScatteredRay, 2>> both_ways(const SurfaceHit& hit, const Vec3& wo_local,
                                                            Transport transport) {
    const auto lobes = hit.bsdf->delta_pair_local(wo_local, transport);
    if (!lobes) return std::nullopt;
    const auto first = detail::scattered_ray(hit, wo_local, (*lobes)[0], 1.f, transport),
               second = detail::scattered_ray(hit, wo_local, (*lobes)[1], 1.f, transport);
    return first && second ? std::optional(std::array{*first, *second}) : std::nullopt;
}

}  // namespace gib
