#pragma once
// Samples of lights from a surface or a medium, with a weight that the caller gives. Source: Veach 1997, chapter 8.

#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"

#include <cmath>

namespace gib {

/// The light of one sample that the hit scatters. `visibility(light)` returns the share of its radiance that arrives,
/// `weight(density)` the weight of the sample if the lobes have this density in its direction.
/// Inlined, since scenes without media would pay for a call at every vertex.
template <typename Weight, typename Visibility>
[[gnu::always_inline]] inline LobeValues scattered_from(const LightSample& light, const SurfaceHit& hit,
                                                        const Vec3& wo_local, Lobes which, Weight&& weight,
                                                        Visibility&& visibility) {
    if (hit.delta_only || !hit.normals_agree_about(light.wi)) return {};
    const Vec3 wi_local = hit.shading.to_local(light.wi);
    const LobeValues f = hit.bsdf->f_local(wo_local, wi_local);
    if (is_black(f.of(which) * light.Le)) return {};
    // The processor divides while the shadow ray is traced.
    const float per_radiance =
        std::abs(wi_local.z()) * weight([&] { return hit.bsdf->pdf_w_local(wo_local, wi_local, which); }) / light.pdf_w;
    const Color visible = visibility(light);
    if (is_black(visible)) return {};
    const Color incident = light.Le * (visible * per_radiance);
    return {includes(which, LobeKind::diffuse) ? Color(f.diffuse * incident) : Color(Color::Zero()),
            includes(which, LobeKind::specular) ? Color(f.specular * incident) : Color(Color::Zero())};
}

/// One sample of the radiance [W/(sr m^2)] that the lobes `which` of the hit scatter towards wo straight from a light, times
/// weight_of(light, by_lobes), where by_lobes() is the density of these lobes in its direction [1/sr]. The path arrives in
/// `medium` (null: vacuum); `flights` are the numbers of transmittances.
template <typename Weight>
[[gnu::always_inline]] inline LobeValues sampled_for_surface(RayQueries& rays, const SurfaceHit& hit,
                                                             const Vec3& wo_local, const VertexNumbers& u,
                                                             const Medium* medium, NumberStream& flights,
                                                             Weight&& weight_of, Lobes which) {
    const Scene& scene = rays.scene();
    const auto light =
        scene.sample_light(hit.lit_for(hit.shading.to_world(wo_local)), u.light_choice(), u.light_position());
    if (!light) return {};
    const auto weight = [&](auto by_lobes) { return weight_of(*light, by_lobes); };
    if (!scene.has_media())
        return scattered_from(*light, hit, wo_local, which, weight,
                              [&](const LightSample& to) { return rays.visibility(hit, to); });
    return scattered_from(*light, hit, wo_local, which, weight, [&](const LightSample& to) {
        const Medium* beyond = scene.medium_beyond(hit, to.wi, medium);
        return rays.transmittance(offset_origin(hit, to.wi), beyond, to, flights);
    });
}

/// The same for a scattering event at p in the medium, whose phase function is a density.
template <typename Weight>
[[gnu::always_inline]] inline Color sampled_for_medium(RayQueries& rays, const Vec3& p, const Vec3& wo,
                                                       const VertexNumbers& u, const Medium& medium,
                                                       NumberStream& flights, Weight&& weight_of) {
    const auto light = rays.scene().sample_light(p, u.light_choice(), u.light_position());
    if (!light || is_black(light->Le)) return Color::Zero();
    const Color visibility = rays.transmittance(p, &medium, *light, flights);
    const float phase = medium.phase().value(wo, light->wi);
    const float weight = weight_of(*light, [&] { return phase; });
    return light->Le * visibility * (phase * weight / light->pdf_w);
}

}  // namespace gib
