#pragma once
// Terms that the two principled models share. Sources: Burley 2012, "Physically Based Shading at Disney", and Burley
// 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering" (SIGGRAPH course notes).

#include "common/materials/fresnel.h"
#include "common/materials/microfacet.h"
#include "common/materials/scattering.h"

#include <algorithm>

namespace gib::burley {

inline float lerp(float a, float b, float t) { return a + t * (b - a); }

/// Schlick's weight (1 - cos)^5.
inline float schlick_weight(float cosine) {
    const float x = std::clamp(1.f - cosine, 0.f, 1.f);
    return sqr(sqr(x)) * x;
}
/// Schlick's weight by the cosine in the medium of lower index, where it is 1 at total reflection.
inline float schlick_weight(float cosine, float eta_ti) {
    return schlick_weight(eta_ti > 1.f ? cosine : std::abs(fresnel_dielectric(cosine, eta_ti).cos_t));
}

inline Color schlick(const Color& f0, float weight) { return f0 + weight * (1.f - f0); }

/// A base colour of luminance 1; white if it is black.
inline Color tint_of(const Color& base_color) {
    const float y = luminance(base_color);
    return y > 0.f ? Color(base_color / y) : Color(Color::Ones());
}

/// alpha_u = roughness^2 / a and alpha_v = roughness^2 a with a = sqrt(1 - 0.9 anisotropic), at least 0.001.
inline MicrofacetDistribution facets(float roughness, float anisotropic) {
    constexpr float least_alpha = 1e-3f;
    const float aspect = std::sqrt(1.f - 0.9f * anisotropic), alpha = sqr(roughness);
    return {MicrofacetType::ggx, std::max(alpha / aspect, least_alpha), std::max(alpha * aspect, least_alpha)};
}

/// Diffuse light and retro-reflection, which `flatness` blends with approximate subsurface scattering: f pi over the
/// base colour. The cosines are those of both directions to the normal and of their angle d to the facet.
inline float diffuse(float roughness, float flatness, float cos_o, float cos_i, float cos_d) {
    const float w_o = schlick_weight(cos_o), w_i = schlick_weight(cos_i);
    const float r = 2.f * roughness * sqr(cos_d);
    const float plain = (1.f - 0.5f * w_o) * (1.f - 0.5f * w_i) + r * (w_o + w_i + w_o * w_i * (r - 1.f));
    const float s = lerp(1.f, 0.5f * r, w_o) * lerp(1.f, 0.5f * r, w_i);
    const float flat = 1.25f * (s * (1.f / (cos_o + cos_i) - 0.5f) + 0.5f);
    return lerp(plain, flat, flatness);
}

/// The coefficients, divided by their largest channel where that is above 1: they are estimates of albedos.
inline ScatteringCoefficients at_most_one(ScatteringCoefficients c) {
    const float highest = (c.diffuse + c.specular).maxCoeff();
    if (highest > 1.f) {
        c.diffuse /= highest;
        c.specular /= highest;
    }
    return c;
}

}  // namespace gib::burley
