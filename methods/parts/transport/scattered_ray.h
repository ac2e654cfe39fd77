#pragma once
// Scattered rays: samples of a surface's Bsdf, for paths from the eye (radiance) and from the lights (power), that
// lead no light through a closed surface, whatever its shading normals are, and that agree with each other.
//
// Where a mesh has interpolated normals, the shading normal ns and the geometric normal ng disagree about the side on
// which some directions lie. There a reflection would leave on the back of the surface, and a refraction would return
// to the side that it came from (Veach 1997, section 5.3). So diffuse and glossy lobes scatter nothing if the normals
// disagree about wi or wo. A surface with delta lobes only (a mirror, a smooth interface) has no other direction to
// send the light to; its lobes scatter about ng if the normals disagree about wo or about any direction that its
// lobes about ns would take. Which of the two normals counts depends on wo alone: is_about_interpolated(hit, wo).
//
// Let K(wo, wi) = f |cos(wi, n)| be that kernel for radiance, with the normal n that wo chooses. A photon that arrives
// from wi carries the flux L |wi.ng| dA dwi through the surface, so the share of its power that goes into dwo is
//     K*(wi, wo) dwo = K(wo, wi) |wo.ng| / |wi.ng| dwo.
// Against a sample of f(wi, wo) |cos(wo, n)| this is a factor |wo.ng| |wi.n| / (|wo.n| |wi.ng|) (Veach 1997, section
// 5.3). The normal is chosen by the direction in which the photon LEAVES: wherever both normals have such a direction,
// one of them is taken with probability 1/2, and a photon that leaves in a direction that chooses the other one ends.

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
    float eta;  ///< index of refraction on wi's side over that on wo's side; 1 without refraction
};

/// Whether the delta lobes of the surface scatter light that the eye sees in direction w about the interpolated normal
/// rather than the geometric one. Lobes of a surface that has others too, or bump-mapped ones, do so wherever the
/// normals agree about w; a sample about which they disagree is dropped.
inline bool is_about_interpolated(const SurfaceHit& hit, const Vec3& w) {
    if (!hit.file_normals_agree_about(w)) return false;
    const LobeTraits& lobes = hit.bsdf->traits();
    if (lobes.diffuse || lobes.glossy || hit.bsdf->is_tilted()) return true;
    const Frame frame(hit.interpolated);
    const Vec3 w_local = frame.to_local(w);
    const auto agrees = [&](const Vec3& to) { return hit.file_normals_agree_about(frame.to_world(to)); };
    if (!agrees({-w_local.x(), -w_local.y(), w_local.z()})) return false;
    const auto pair = hit.bsdf->delta_pair_local(w_local, Transport::radiance);
    return !pair || (agrees((*pair)[0].wi) && agrees((*pair)[1].wi));
}

namespace detail {

/// Made in place, member by member: the copy of a whole ray would wait until its members are stored.
inline std::optional<ScatteredRay> scattered_ray(const Frame& frame, const BsdfSample& sample, float probability) {
    std::optional<ScatteredRay> ray(std::in_place);
    ray->wi = frame.to_world(sample.wi);
    ray->weight = sample.f * (std::abs(sample.wi.z()) / probability);
    ray->pdf_w = sample.pdf_w;
    ray->delta = sample.delta;
    ray->lobe = sample.lobe;
    ray->eta = sample.eta;
    return ray;
}

/// The frame around the geometric normal, on the side of the interpolated one.
inline Frame geometric_frame(const SurfaceHit& hit) {
    return Frame(hit.interpolated.dot(hit.ng) > 0.f ? hit.ng : Vec3(-hit.ng));
}

/// Whether a photon from w may leave about the geometric normal in a direction that chooses this normal. True for
/// mixtures that transmit, whose delta lobes cannot be listed.
inline bool may_leave_about_geometric(const SurfaceHit& hit, const Vec3& w) {
    const Bsdf& bsdf = *hit.bsdf;
    if (!bsdf.traits().delta || bsdf.is_tilted()) return false;
    if (bsdf.traits().transmission && bsdf.layers().size() > 1) return true;
    const Frame frame = geometric_frame(hit);
    const Vec3 w_local = frame.to_local(w);
    const auto leaves = [&](const Vec3& to) { return !is_about_interpolated(hit, frame.to_world(to)); };
    if (leaves({-w_local.x(), -w_local.y(), w_local.z()})) return true;
    const auto pair = bsdf.delta_pair_local(w_local, Transport::power);
    return pair && (leaves((*pair)[0].wi) || leaves((*pair)[1].wi));
}

/// A sample of the Bsdf about the interpolated normal or, of its delta lobes alone, about the geometric one.
struct NormalChoice {
    bool geometric;
    float probability;  ///< probability of this choice
};
inline std::optional<ScatteredRay> sample_about(const SurfaceHit& hit, const Vec3& wo_local, const NormalChoice& normal,
                                                const Vec2& u_lobe, const Vec2& u, Transport transport, Lobes which) {
    const bool other = normal.geometric && !hit.delta_only;
    const Frame frame = other ? geometric_frame(hit) : hit.shading;
    const Vec3 from = other ? frame.to_local(hit.shading.to_world(wo_local)) : wo_local;
    const auto sample = hit.bsdf->sample_local(from, u_lobe, u, transport, which);
    if (!sample || (normal.geometric && (!sample->delta || hit.bsdf->is_tilted()))) return std::nullopt;
    auto ray = scattered_ray(frame, *sample, sample->pdf_w * normal.probability);
    if (transport == Transport::radiance || normal.geometric) return ray;
    const Vec3 wo = hit.shading.to_world(wo_local);
    const float denominator = std::abs(ray->wi.dot(frame.n) * wo.dot(hit.ng));
    if (!(denominator > 0.f)) return std::nullopt;
    ray->weight *= std::abs(ray->wi.dot(hit.ng) * wo.dot(frame.n)) / denominator;
    return ray;
}

/// sample_scattering() of radiance where the normals differ.
inline std::optional<ScatteredRay> sample_radiance(const SurfaceHit& hit, const Vec3& wo_local, const Vec2& u_lobe,
                                                   const Vec2& u, Lobes which) {
    const LobeTraits& lobes = hit.bsdf->traits();
    const bool chooses = lobes.delta && !lobes.diffuse && !lobes.glossy;
    const bool geometric = hit.delta_only || (chooses && !is_about_interpolated(hit, hit.shading.to_world(wo_local)));
    const auto ray = sample_about(hit, wo_local, {geometric, 1.f}, u_lobe, u, Transport::radiance, which);
    return ray && (geometric || hit.normals_agree_about(ray->wi)) ? ray : std::nullopt;
}

/// sample_radiance() for power: wo_local is the direction that the photon came from.
inline std::optional<ScatteredRay> sample_power(const SurfaceHit& hit, const Vec3& wo_local, Vec2 u_lobe, const Vec2& u,
                                                Lobes which) {
    const float share = hit.delta_only                                                   ? 1.f
                        : may_leave_about_geometric(hit, hit.shading.to_world(wo_local)) ? 0.5f
                                                                                         : 0.f;
    const bool geometric = u_lobe.y() < share;
    const float probability = geometric ? share : 1.f - share;
    u_lobe.y() = (geometric ? u_lobe.y() : u_lobe.y() - share) / probability;
    const auto ray = sample_about(hit, wo_local, {geometric, probability}, u_lobe, u, Transport::power, which);
    if (!ray) return std::nullopt;
    const bool allowed =
        ray->delta ? is_about_interpolated(hit, ray->wi) != geometric : hit.normals_agree_about(ray->wi);
    return allowed ? ray : std::nullopt;
}

}  // namespace detail

/// One ray by a sample of the Bsdf (Bsdf::sample_local()), weighted for the quantity that the path carries. `wo_local`
/// points to where the path came from, in the frame of the hit. Empty if nothing is scattered.
inline std::optional<ScatteredRay> sample_scattering(const SurfaceHit& hit, const Vec3& wo_local, const Vec2& u_lobe,
                                                     const Vec2& u, Transport transport, Lobes which = Lobes::all) {
    if (hit.is_flat()) {
        const auto sample = hit.bsdf->sample_local(wo_local, u_lobe, u, transport, which);
        if (!sample) return std::nullopt;
        return detail::scattered_ray(hit.shading, *sample, sample->pdf_w);
    }
    return transport == Transport::radiance ? detail::sample_radiance(hit, wo_local, u_lobe, u, which)
                                            : detail::sample_power(hit, wo_local, u_lobe, u, which);
}

/// The reflected and the refracted ray of radiance at a smooth interface (Bsdf::delta_pair_local()). Empty if there
/// are not two.
inline std::optional<std::array<ScatteredRay, 2>> both_ways(const SurfaceHit& hit, const Vec3& wo_local) {
    const Vec3 wo = hit.shading.to_world(wo_local);
    const bool other = !hit.delta_only && !hit.is_flat() && !is_about_interpolated(hit, wo);
    const Frame frame = other ? detail::geometric_frame(hit) : hit.shading;
    const auto lobes = hit.bsdf->delta_pair_local(other ? frame.to_local(wo) : wo_local, Transport::radiance);
    if (!lobes) return std::nullopt;
    return std::array{*detail::scattered_ray(frame, (*lobes)[0], 1.f), *detail::scattered_ray(frame, (*lobes)[1], 1.f)};
}

}  // namespace gib
