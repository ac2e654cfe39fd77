#pragma once
// The principled model: many materials from a few parameters between 0 and 1. Sources: Burley 2012, "Physically Based
// Shading at Disney", and Burley 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering"
// (SIGGRAPH course notes); the parameters and their ranges are those of Mitsuba 3's `principled`.

#include "common/materials/microfacet.h"
#include "common/materials/scattering.h"

namespace gib {

/// The sum of five lobes. With m the facet that takes wi to wo, d its angle with both, w(x) = (1 - cos x)^5 Schlick's
/// weight, c the base colour, c / Y(c) its tint (white if it is black), D and G1 those of GGX:
///  - diffuse and retro-reflection, of weight (1 - metallic) (1 - spec_trans): c / pi times
///        (1 - w_i / 2) (1 - w_o / 2) + R (w_i + w_o + w_i w_o (R - 1)),   R = 2 roughness cos^2 d;
///    `flatness` blends it with Burley's approximation of subsurface scattering
///        1.25 (S (1 / (cos_i + cos_o) - 1/2) + 1/2),   S = (1 + w_i (R / 2 - 1)) (1 + w_o (R / 2 - 1));
///  - sheen: (1 - metallic) sheen w(d) lerp(1, tint, sheen_tint), without 1 / pi;
///  - main reflection: F D G1(wo) G1(wi) / (4 cos_o cos_i), where F blends the dielectric's exact reflectance, that of
///    Schlick with F0 = tint ((eta - 1) / (eta + 1))^2 (`spec_tint`), and that of a metal, Schlick with F0 = c;
///    from inside, F is (1 - metallic) spec_trans times the dielectric's;
///  - main refraction, of weight (1 - metallic) spec_trans sqrt(c): that of a rough dielectric;
///  - clear coat: clearcoat / 4 F D1 G1(wo) G1(wi) with Schlick's F0 = 0.04, the density D1 of Gtr1 and Smith's G1 of
///    GGX at roughness 0.25. As in Mitsuba 3 this lobe is not divided by 4 cos_o cos_i, as it is in Burley's paper.
/// Main lobes have alpha_u = roughness^2 / a and alpha_v = roughness^2 a with a = sqrt(1 - 0.9 anisotropic), at least
/// 0.001. Without refraction the model is one-sided. It is reciprocal, but bright base colours reflect more light than
/// they receive. A white base of specular 0.5 reflects, at 0, 60 and 80 degrees to the normal, 1.03, 1.07 and 1.23 of
/// the light at roughness 0.2, and 1.05, 1.08 and 1.31 at roughness 1; a full clear coat adds 0.03, sheen 0.05.
struct Principled {
    Color base_color = Color::Constant(0.5f);
    float roughness = 0.5f;
    float anisotropic = 0.f;
    float metallic = 0.f;
    float spec_trans = 0.f;
    float spec_tint = 0.f;
    float sheen = 0.f, sheen_tint = 0.f;
    float flatness = 0.f;
    float clearcoat = 0.f, clearcoat_gloss = 0.f;
    float eta = 1.5f;  ///< interior index / exterior index; with 1 only a metal has main lobes

    /// The eta whose reflectance at normal incidence is 0.08 `specular`.
    static double eta_of_specular(double specular);

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                           Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    struct MainEvent;
    struct Choice;

    float opaque() const { return (1.f - metallic) * (1.f - spec_trans); }
    float transparent() const { return (1.f - metallic) * spec_trans; }
    bool transmits() const { return transparent() > 0.f && eta != 1.f; }
    /// Whether the model scatters light from this side.
    bool scatters_from(float cos_o) const { return cos_o > 0.f || (cos_o < 0.f && transmits()); }
    MicrofacetDistribution distribution() const;
    LobeKind main_kind() const { return kind_of_roughness(distribution().roughness()); }
    Color tint() const;
    Color diffuse_f(float cos_o, float cos_i, float cos_d) const;
    Color main_reflectance(float cos_d, float dielectric, bool below) const;
    Color main_transmittance(float dielectric) const;
    std::optional<MainEvent> main_event(const Vec3& wo, const Vec3& wi) const;
    float clearcoat_f(const Vec3& wo, const Vec3& wi) const;
    ScatteringCoefficients estimate(float cos_o) const;
    Choice choice(float cos_o, Lobes which) const;
    std::optional<Vec3> sample_main(const Vec3& wo, float u_lobe, const Vec2& u) const;
};

}  // namespace gib
