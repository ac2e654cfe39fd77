#include "methods/parts/transport/direct_light.h"

#include "methods/parts/transport/light_sample.h"
#include "methods/parts/transport/scattered_ray.h"

namespace gib {

namespace {

/// The weight of a light sample for the caller's techniques; `by_lobes()` is the density of its lobes or phase function.
struct WeightOf {
    LightTechniques techniques;

    template <typename Density>
    [[gnu::always_inline]] inline float operator()(const LightSample& light, Density by_lobes) const {
        const bool combine = techniques == LightTechniques::light_and_bsdf_sampling && !light.delta;
        return combine ? power_heuristic(light.pdf_w, by_lobes()) : 1.f;
    }
};

}  // namespace

LobeValues sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                               const Surroundings& surroundings, LightTechniques techniques, Lobes which) {
    return sampled_for_surface(rays, hit, wo_local, u, surroundings.medium, surroundings.flights, WeightOf{techniques},
                               which);
}

Color sample_direct_light(RayQueries& rays, const Vec3& p, const Vec3& wo, const VertexNumbers& u,
                          const Surroundings& surroundings, LightTechniques techniques) {
    return sampled_for_medium(rays, p, wo, u, *surroundings.medium, surroundings.flights, WeightOf{techniques});
}

LobeValues direct_light_of(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const LightSample& light,
                           ShadowRay shadow_ray, Lobes which) {
    return scattered_from(
        light, hit, wo_local, which, [](auto) { return 1.f; },
        [&](const LightSample& to) {
            return shadow_ray == ShadowRay::skipped ? Color(Color::Ones()) : rays.visibility(hit, to);
        });
}

LobeValues follow_to_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                           Lobes which) {
    LobeValues found;
    const LitPoint lit = hit.lit_for(hit.shading.to_world(wo_local));
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
