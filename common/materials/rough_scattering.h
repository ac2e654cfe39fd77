#pragma once
// Rough conductors and dielectrics: interfaces made of facets, each of them smooth (Walter et al. 2007). Light is
// followed through one facet only. Light that would meet a second facet is lost; this share grows with the roughness.
// The table shows the lost share of light in percent, without absorption, by alpha and by the angle between wo and
// the normal in degrees:
//
//            dielectric from outside, eta = 1.5                  conductor, F = 1
//            beckmann                  ggx                       beckmann                  ggx
//     alpha     0   30   60   80   89     0   30   60   80   89     0   30   60   80   89     0   30   60   80   89
//     0.01    0.0  0.0  0.0  0.0  5.8   0.0  0.0  0.0  0.1  9.2   0.0  0.0  0.0  0.0  6.1   0.0  0.0  0.0  0.2  9.9
//     0.1     0.0  0.0  0.0  3.9  4.3   0.1  0.2  0.8  5.8  7.7   0.0  0.0  0.0  6.2  5.0   1.2  1.4  3.1 10.8  8.8
//     0.2     0.0  0.0  0.7  5.6  3.3   0.5  0.8  2.8  8.7 11.8   0.0  0.0  2.8  9.2  4.3   5.2  6.1 10.6 15.2  9.9
//     0.3     0.0  0.1  2.1  5.0  2.9   1.2  1.7  5.3 12.5 19.3   0.0  0.9  7.7  8.8  4.2  12.3 13.7 18.2 17.9 12.4
//     0.5     0.3  0.9  3.7  4.8  4.7   3.2  4.6 11.8 24.8 36.6   5.7  9.7 13.1  8.2  4.4  31.2 31.9 31.4 25.3 19.4
//     0.7     1.3  2.3  4.8  8.9 12.8   5.9  8.3 19.9 38.1 51.5  25.1 23.4 16.5  8.8  5.2  49.7 48.6 43.4 34.3 27.5
//     1       3.3  4.6  9.4 21.0 29.8  10.7 15.1 32.8 54.1 67.0  53.9 45.2 24.4 12.0  7.7  69.3 67.1 59.1 47.7 39.7

#include "common/materials/microfacet.h"
#include "common/materials/smooth_scattering.h"

namespace gib {

/// A rough conductor, one-sided. With D the density of normals, F the Fresnel reflectance at the facet and A(w) = w.z
/// / G1(w) the visible area:
///     f = F D(m) G1(wo) G1(wi) / (4 wo.z wi.z) = F D(m) / (4 A(wo) A(wi))       (Walter et al. 2007, equation 20)
///     pdf_w = D(m) / (4 A(wo))                                                  visible normals, mirrored
/// Masking is separable, as in Mitsuba 3. The weight of a sample is F G1(wi) <= 1. Directions below the horizon are
/// rejected, so that the density integrates to less than 1 by their share.
struct RoughConductor {
    std::optional<ConductorIndex> index;  ///< none: F = 1
    MicrofacetDistribution distribution;
    Color specular_reflectance = Color::Ones();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    Color reflectance(float cos_o) const;
};

/// A rough interface between two dielectrics; `eta` = interior index / exterior index. With J = wo.m dm/dwi of the
/// facet, which is 1 / 4 for a reflection and eta_ti^2 |wo.m| |wi.m| / |wo + eta_ti wi|^2 for a refraction (Walter et
/// al. 2007, equations 14 and 17; 20 and 21 for f):
///     pdf_w = F D(m) J / A(wo)             or (1 - F) D(m) J / A(wo)
///     f     = F D(m) J / (A(wo) A(wi))     or (1 - F) D(m) J / (A(wo) A(wi)); divided by eta_ti^2 for radiance
/// A sample reflects at its facet with probability F and otherwise refracts; its weight is G1(wi). Directions on the
/// wrong side of the mean surface are rejected. With eta = 1 there is no interface: light goes straight on, as a
/// delta lobe.
struct RoughDielectric {
    float eta = 1.f;
    float cauchy_b = 0.f;  ///< as in Dielectric
    MicrofacetDistribution distribution;
    Color specular_reflectance = Color::Ones();
    Color specular_transmittance = Color::Ones();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                           Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    struct Event;
    std::optional<Event> event(const Vec3& wo, const Vec3& wi) const;
    /// The factors of the lobes: tint, and the scaling of refracted radiance.
    Color transmission(Transport transport, float eta_ti) const;
};

}  // namespace gib
