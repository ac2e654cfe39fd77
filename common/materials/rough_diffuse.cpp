#include "common/materials/rough_diffuse.h"

#include "common/sampling/warp.h"

#include <algorithm>

namespace gib {

namespace {

bool both_above(const Vec3& wo, const Vec3& wi) { return wo.z() > 0.f && wi.z() > 0.f; }

float sine_of(const Vec3& w) { return std::hypot(w.x(), w.y()); }

/// The cosine of the angle between the azimuths of two directions; 0 where one of them has none.
float cosine_of_azimuths(const Vec3& a, const Vec3& b) {
    const float sines = sine_of(a) * sine_of(b);
    return sines > 0.f ? std::clamp((a.x() * b.x() + a.y() * b.y()) / sines, -1.f, 1.f) : 0.f;
}

}  // namespace

LobeTraits RoughDiffuse::traits() const {
    const bool scatters = !is_black(reflectance);
    return {.diffuse = scatters, .rough = scatters};
}

LobeValues RoughDiffuse::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (!both_above(wo, wi)) return f;
    const float sigma2 = 0.5f * sqr(alpha), cos_phi = cosine_of_azimuths(wo, wi);
    // a is the direction further from the normal, b the nearer one.
    const Vec3 &a = wo.z() < wi.z() ? wo : wi, &b = wo.z() < wi.z() ? wi : wo;
    const float sin_a = sine_of(a), sin_b = sine_of(b), tan_b = sin_b / b.z();
    const float c1 = 1.f - 0.5f * sigma2 / (sigma2 + 0.33f), slope = sigma2 / (sigma2 + 0.09f);
    if (fast) {
        f.diffuse = reflectance * (inv_pi * (c1 + 0.45f * slope * std::max(cos_phi, 0.f) * sin_a * tan_b));
        return f;
    }
    const float angle_a = std::atan2(sin_a, a.z()), angle_b = std::atan2(sin_b, b.z()),
                share_b = 2.f * inv_pi * angle_b;
    const float c2 = 0.45f * slope * (cos_phi >= 0.f ? sin_a : sin_a - share_b * sqr(share_b));
    const float c3 = 0.125f * slope * sqr(4.f * inv_pi * inv_pi * angle_a * angle_b);
    const float tan_half = (sin_a + sin_b) / (a.z() + b.z());  // of half of the sum of both angles
    const float single = c1 + cos_phi * c2 * tan_b + (1.f - std::abs(cos_phi)) * c3 * tan_half;
    const float twice = 0.17f * sigma2 / (sigma2 + 0.13f) * (1.f - cos_phi * sqr(share_b));
    f.diffuse = (reflectance * inv_pi * (single + reflectance * twice)).max(0.f);
    return f;
}

float RoughDiffuse::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    return which != Lobes::specular && both_above(wo, wi) ? cosine_hemisphere_pdf(wi.z()) : 0.f;
}

std::optional<BsdfSample> RoughDiffuse::sample_local(const Vec3& wo, float, const Vec2& u, Transport transport,
                                                     Lobes which) const {
    if (which == Lobes::specular || !(wo.z() > 0.f)) return std::nullopt;
    const Vec3 wi = square_to_cosine_hemisphere(u);
    return BsdfSample{.wi = wi,
                      .f = f_local(wo, wi, transport).diffuse,
                      .pdf_w = cosine_hemisphere_pdf(wi.z()),
                      .lobe = LobeKind::diffuse};
}

ScatteringCoefficients RoughDiffuse::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c;
    if (wo.z() > 0.f) c.diffuse = reflectance;
    return c;
}

}  // namespace gib
