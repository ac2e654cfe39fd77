#include "methods/parts/transport/direct_light.h"

#include "common/sampling/power_heuristic.h"
#include "methods/parts/transport/scattered_ray.h"

namespace gib {

namespace {

/// The light of one sample that the hit scatters. `visibility(light)` returns the share of its radiance that arrives.
/// Inlined, since scenes without media would pay for a call at every vertex.
template <typename Visibility>
[[gnu::always_inline]] inline LobeValues scattered_from(const LightSample& light, const SurfaceHit& hit,
                                                        const Vec3& wo_local, LightTechniques techniques, Lobes which,
                                                        Visibility&& visibility) {
    if (hit.delta_only || !hit.normals_agree_about(light.wi)) return {};
    const Vec3 wi_local = hit.shading.to_local(light.wi);
    const LobeValues f = hit.bsdf->f_local(wo_local, wi_local);
    if (is_black(f.of(which) * light.Le)) return {};
    const bool combine = techniques == LightTechniques::light_and_bsdf_sampling && !light.delta;
    const float weight = combine ? power_heuristic(light.pdf_w, hit.bsdf->pdf_w_local(wo_local, wi_local, which)) : 1.f;
    // The processor divides while the shadow ray is traced.
    const float per_radiance = std::abs(wi_local.z()) * weight / light.pdf_w;
    const Color visible = visibility(light);
    if (is_black(visible)) return {};
    const Color incident = light.Le * (visible * per_radiance);
    return {includes(which, LobeKind::diffuse) ? Color(f.diffuse * incident) : Color(Color::Zero()),
            includes(which, LobeKind::specular) ? Color(f.specular * incident) : Color(Color::Zero())};
}

}  // namespace

LobeValues sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                               const Surroundings& surroundings, LightTechniques techniques, Lobes which) {
    const Scene& scene = rays.scene();
    const auto light =
        scene.sample_light(scene.lit(hit, hit.shading.to_world(wo_local)), u.light_choice(), u.light_position());
    if (!light) return {};
    if (!scene.has_media())
        return scattered_from(*light, hit, wo_local, techniques, which,
                              [&](const LightSample& to) { return rays.visibility(hit, to); });
    return scattered_from(*light, hit, wo_local, techniques, which, [&](const LightSample& to) {
        const Medium* medium = scene.medium_beyond(hit, to.wi, surroundings.medium);
        return rays.transmittance(offset_origin(hit, to.wi), medium, to, surroundings.flights);
    });
}

Color sample_direct_light(RayQueries& rays, const Vec3& p, const Vec3& wo, const VertexNumbers& u,
                          const Surroundings& surroundings, LightTechniques techniques) {
    const auto light = rays.scene().sample_light(p, u.light_choice(), u.light_position());
    if (!light || is_black(light->Le)) return Color::Zero();
    const Color visibility = rays.transmittance(p, surroundings.medium, *light, surroundings.flights);
    const float phase = surroundings.medium->phase().value(wo, light->wi);
    const bool combine = techniques == LightTechniques::light_and_bsdf_sampling && !light->delta;
    const float weight = combine ? power_heuristic(light->pdf_w, phase) : 1.f;
    return light->Le * visibility * (phase * weight / light->pdf_w);
}

LobeValues direct_light_of(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const LightSample& light,
                           Lobes which) {
    return scattered_from(light, hit, wo_local, LightTechniques::light_sampling_only, which,
                          [&](const LightSample& to) { return rays.visibility(hit, to); });
}

LobeValues follow_to_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                           Lobes which) {
    LobeValues found;
    const LitPoint lit = rays.scene().lit(hit, hit.shading.to_world(wo_local));
    const auto next = sample_scattering(hit, wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance, which);
    if (!next || next->delta) return found;
    Color beta = next->weight;
    Ray ray = hit.spawn_ray(next->wi);
    while (!is_black(beta)) {
        const auto light = rays.intersect(ray);
        if (!light) {
            found.add(next->lobe, beta * escaped_radiance(rays.scene(), lit, next->pdf_w, ray.d));
            break;
        }
        const Color Le = light->Le(-ray.d);
        if (!is_black(Le))
            found.add(next->lobe, beta * Le * bsdf_sampling_weight(rays.scene(), lit, next->pdf_w, *light));
        beta *= light->straight_on(ray.d);
        ray = light->spawn_ray(ray.d);
    }
    return found;
}

Color escaped_radiance(const Scene& scene, const LitPoint& previous, float pdf_w, const Vec3& w) {
    if (!scene.environment()) return Color::Zero();
    const float weight = std::isfinite(pdf_w) ? power_heuristic(pdf_w, scene.environment_pdf_w(previous, w)) : 1.f;
    return weight * scene.environment_radiance(w);
}

float bsdf_sampling_weight(const Scene& scene, const LitPoint& previous, float pdf_w, const SurfaceHit& hit) {
    if (!std::isfinite(pdf_w)) return 1.f;
    return power_heuristic(pdf_w, scene.light_pdf_w(previous, hit));
}

}  // namespace gib
