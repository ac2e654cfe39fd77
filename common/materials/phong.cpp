#include "common/materials/phong.h"

#include "common/sampling/warp.h"

namespace gib {

namespace {

/// cos^n of the angle between two unit vectors, 0 beyond a right angle. 1 - cos is half their squared distance: this
/// keeps the digits of a small angle, on which a high power depends.
float cosine_power(const Vec3& a, const Vec3& b, float n) {
    const float one_minus_cos = 0.5f * (a - b).squaredNorm();
    return one_minus_cos < 1.f ? std::exp(n * std::log1p(-one_minus_cos)) : 0.f;
}

}  // namespace

std::optional<float> Phong::glossy_probability(Lobes which) const {
    const float diffuse = which == Lobes::specular ? 0.f : diffuse_reflectance.mean();
    const float glossy = includes(which, glossy_kind()) ? specular_reflectance.mean() : 0.f;
    if (!(diffuse + glossy > 0.f)) return std::nullopt;
    return glossy / (diffuse + glossy);
}

LobeTraits Phong::traits() const {
    LobeTraits t;
    t.diffuse = !is_black(diffuse_reflectance);
    if (is_black(specular_reflectance)) return t;
    t.rough = true;
    (glossy_kind() == LobeKind::diffuse ? t.diffuse : t.glossy) = true;
    return t;
}

LobeValues Phong::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return f;
    f.diffuse = diffuse_reflectance * inv_pi;
    const float lobe = 0.5f * inv_pi * (exponent + 2.f) * cosine_power(mirrored(wo), wi, exponent);
    f.add(glossy_kind(), specular_reflectance * lobe);
    return f;
}

float Phong::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return 0.f;
    const std::optional<float> glossy = glossy_probability(which);
    if (!glossy) return 0.f;
    const float lobe = 0.5f * inv_pi * (exponent + 1.f) * cosine_power(mirrored(wo), wi, exponent);
    return *glossy * lobe + (1.f - *glossy) * cosine_hemisphere_pdf(wi.z());
}

std::optional<BsdfSample> Phong::sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                              Lobes which) const {
    const std::optional<float> glossy = glossy_probability(which);
    if (!(wo.z() > 0.f) || !glossy) return std::nullopt;
    const bool is_glossy = u_lobe < *glossy;
    Vec3 wi;
    if (is_glossy) {
        // cos = u^(1 / (n + 1)) for u in (0, 1]; expm1 and log1p give 1 - cos without cancellation.
        const float one_minus_cos = -std::expm1(std::log1p(-u.y()) / (exponent + 1.f));
        const float sine = safe_sqrt(one_minus_cos * (2.f - one_minus_cos)), phi = 2.f * pi * u.x();
        wi = Frame(mirrored(wo))
                 .to_world({sine * std::cos(phi), sine * std::sin(phi), 1.f - one_minus_cos})
                 .normalized();
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

ScatteringCoefficients Phong::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c;
    if (!(wo.z() > 0.f)) return c;
    c.diffuse = diffuse_reflectance;
    (glossy_kind() == LobeKind::diffuse ? c.diffuse : c.specular) += specular_reflectance;
    return c;
}

}  // namespace gib
