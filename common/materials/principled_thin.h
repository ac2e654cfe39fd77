#pragma once
// The thin form of the principled model: leaves, paper, thin panes. Sources: Burley 2015, "Extending the Disney BRDF to
// a BSDF with Integrated Subsurface Scattering" (SIGGRAPH course notes); the parameters and their ranges are those of
// Mitsuba 3's `principledthin`.

#include "common/materials/microfacet.h"
#include "common/materials/scattering.h"

namespace gib {

/// A sheet without thickness, alike on both sides: no light is bent. With t = diff_trans / 2, the names of Principled
/// and wi' for wi mirrored in the sheet, f is the sum of
///  - on the side of wo, (1 - spec_trans) (1 - t) times Principled's diffuse light with `flatness`, and sheen;
///  - through the sheet, (1 - spec_trans) t c / pi;
///  - on the side of wo, spec_trans F D G1(wo) G1(wi) / (4 cos_o cos_i), where F blends the exact reflectance of one
///    interface of index eta with Schlick's of F0 = tint ((eta - 1) / (eta + 1))^2 (`spec_tint`);
///  - through the sheet, spec_trans c (1 - F) D' G1'(wo) G1'(wi') / (4 cos_o cos_i) with the exact F. D' is that of the
///    roughness times 0.65 eta - 0.35, because light is bent twice and leaves in its old direction (Burley 2015).
struct PrincipledThin {
    Color base_color = Color::Constant(0.5f);
    float roughness = 0.5f;
    float anisotropic = 0.f;
    float spec_trans = 0.f;
    float diff_trans = 0.f;  ///< 0 to 2: twice the transmitted share of diffuse light
    float spec_tint = 0.f;
    float sheen = 0.f, sheen_tint = 0.f;
    float flatness = 0.f;
    float eta = 1.5f;  ///< interior index / exterior index

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                           Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    struct Shares;

    /// The facets that reflect (`through` false) or transmit.
    MicrofacetDistribution distribution(bool through) const;
    LobeKind main_kind(bool through) const { return kind_of_roughness(distribution(through).roughness()); }
    Color reflectance(float cos_d) const;
    Color transmittance(float cos_d) const;
    Color sheen_color() const;
    Shares shares(float cos_o) const;
    Shares choice(float cos_o, Lobes which) const;
};

}  // namespace gib
