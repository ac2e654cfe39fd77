#pragma once
// Phong's reflection model, modified to conserve energy.

#include "common/materials/scattering.h"

namespace gib {

/// With alpha the angle between wi and the mirror direction of wo, one-sided:
///     f = rho_d / pi + rho_s (n + 2) / (2 pi) cos(alpha)^n                    (Lafortune and Willems 1994, equation 8)
/// At normal incidence the second lobe reflects rho_s; at others less, as a part of it lies below the surface. Its
/// samples have the density (n + 1) / (2 pi) cos(alpha)^n (ibid., equation 12), whose part below the surface is missing
/// from the integral of pdf_w. A lobe is chosen by its mean reflectance. The glossy one counts as one of roughness
/// sqrt(2 / (n + 2)), the Beckmann distribution of about its width.
struct Phong {
    Color diffuse_reflectance = Color::Constant(0.5f);
    Color specular_reflectance = Color::Constant(0.2f);
    float exponent = 30.f;  ///< n, from 0 to highest_exponent
    /// Beyond it single precision does not hold a direction in the lobe.
    static constexpr float highest_exponent = 1e8f;

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    /// Of the glossy lobe its upper bound.
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    LobeKind glossy_kind() const { return kind_of_roughness(std::sqrt(2.f / (exponent + 2.f))); }
    /// The probability of sampling the glossy lobe; none if nothing is to be sampled.
    std::optional<float> glossy_probability(Lobes which) const;
};

}  // namespace gib
