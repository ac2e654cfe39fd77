#include "common/materials/ward.h"

#include "common/sampling/warp.h"

namespace gib {

std::optional<float> Ward::glossy_probability(Lobes which) const {
    const float diffuse = which == Lobes::specular ? 0.f : diffuse_reflectance.mean();
    const float glossy = includes(which, glossy_kind()) ? specular_reflectance.mean() : 0.f;
    if (!(diffuse + glossy > 0.f)) return std::nullopt;
    return glossy / (diffuse + glossy);
}

LobeTraits Ward::traits() const {
    LobeTraits t;
    t.diffuse = !is_black(diffuse_reflectance);
    if (is_black(specular_reflectance)) return t;
    t.rough = true;
    t.anisotropic = distribution.alpha_u != distribution.alpha_v;
    (glossy_kind() == LobeKind::diffuse ? t.diffuse : t.glossy) = true;
    return t;
}

LobeValues Ward::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return f;
    const Facet facet = reflecting_facet(wo, wi);
    const float d = distribution.density(facet.m), cosines = wo.z() * wi.z();
    float lobe = 0.25f * d / sqr(facet.cos_o);
    if (variant != Variant::balanced)
        lobe = 0.25f * d * sqr(sqr(facet.m.z())) / (variant == Variant::ward ? std::sqrt(cosines) : cosines);
    f.diffuse = diffuse_reflectance * inv_pi;
    f.add(glossy_kind(), specular_reflectance * lobe);
    return f;
}

float Ward::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return 0.f;
    const std::optional<float> glossy = glossy_probability(which);
    if (!glossy) return 0.f;
    const Facet facet = reflecting_facet(wo, wi);
    const float lobe = 0.25f * distribution.density(facet.m) * facet.m.z() / facet.cos_o;
    return *glossy * lobe + (1.f - *glossy) * cosine_hemisphere_pdf(wi.z());
}

std::optional<BsdfSample> Ward::sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                             Lobes which) const {
    const std::optional<float> glossy = glossy_probability(which);
    if (!(wo.z() > 0.f) || !glossy) return std::nullopt;
    const bool is_glossy = u_lobe < *glossy;
    Vec3 wi;
    if (is_glossy) {
        // All normals are visible from above: their density from there is D(m) m.z.
        const Vec3 m = distribution.sample_visible(Vec3::UnitZ(), u);
        if (!(wo.dot(m) > 0.f)) return std::nullopt;
        wi = reflected(wo, m, wo.dot(m));
    } else {
        wi = square_to_cosine_hemisphere(u);
    }
    const float pdf_w = pdf_w_local(wo, wi, which);
    if (!(pdf_w > 0.f)) return std::nullopt;  // below the surface
    return BsdfSample{.wi = wi,
                      .f = f_local(wo, wi, transport).of(which),
                      .pdf_w = pdf_w,
                      .lobe = is_glossy ? glossy_kind() : LobeKind::diffuse};
}

ScatteringCoefficients Ward::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c;
    if (!(wo.z() > 0.f)) return c;
    c.diffuse = diffuse_reflectance;
    (glossy_kind() == LobeKind::diffuse ? c.diffuse : c.specular) += specular_reflectance;
    return c;
}

}  // namespace gib
