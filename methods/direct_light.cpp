#include "methods/direct_light.h"

namespace gib {

Color sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo_local, const Sampler& sampler,
                          int vertex, LightTechniques techniques) {
    const Scene& scene = rays.scene();
    const float u_choice =
        scene.lights().size() > 1 ? sampler.get_1d(dimension::at_vertex(vertex, dimension::light_choice)) : 0.f;
    const auto light =
        scene.sample_light(hit.p, u_choice, sampler.get_2d(dimension::at_vertex(vertex, dimension::light_position)));
    if (!light) return Color::Zero();
    const Vec3 wi_local = hit.shading.to_local(light->wi);
    const Color f = hit.bsdf->f_local(wo_local, wi_local);
    const Color f_Le = f * light->Le;
    if (is_black(f_Le) || !rays.visible(hit, *light)) return Color::Zero();
    const bool combine = techniques == LightTechniques::light_and_bsdf_sampling && !light->delta;
    const float weight = combine ? power_heuristic(light->pdf_w, hit.bsdf->pdf_w_local(wo_local, wi_local)) : 1.f;
    return f_Le * (std::abs(wi_local.z()) * weight / light->pdf_w);
}

}  // namespace gib
