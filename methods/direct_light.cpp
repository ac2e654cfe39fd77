#include "methods/direct_light.h"

namespace gib {

LobeValues sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const Sampler& sampler,
                               int vertex, LightTechniques techniques, Lobes which) {
    const Scene& scene = rays.scene();
    const float u_choice =
        scene.lights().size() > 1 ? sampler.get_1d(dimension::at_vertex(vertex, dimension::light_choice)) : 0.f;
    const auto light =
        scene.sample_light(hit.p, u_choice, sampler.get_2d(dimension::at_vertex(vertex, dimension::light_position)));
    if (!light) return {};
    const Vec3 wi_local = hit.shading.to_local(light->wi);
    const LobeValues f = hit.bsdf->f_local(wo_local, wi_local);
    if (is_black(f.of(which))) return {};
    const float visibility = rays.visibility(hit, *light);
    if (visibility == 0.f) return {};
    const bool combine = techniques == LightTechniques::light_and_bsdf_sampling && !light->delta;
    const float weight =
        combine ? power_heuristic(light->pdf_w, hit.bsdf->pdf_w_local(wo_local, wi_local, which)) : 1.f;
    const Color incident = light->Le * (std::abs(wi_local.z()) * weight * visibility / light->pdf_w);
    return {includes(which, LobeKind::diffuse) ? Color(f.diffuse * incident) : Color(Color::Zero()),
            includes(which, LobeKind::specular) ? Color(f.specular * incident) : Color(Color::Zero())};
}

float bsdf_sampling_weight(const Scene& scene, const Vec3& previous, float pdf_w, const SurfaceHit& hit) {
    if (!std::isfinite(pdf_w)) return 1.f;
    return power_heuristic(pdf_w, scene.light_pdf_w(previous, hit));
}

}  // namespace gib
