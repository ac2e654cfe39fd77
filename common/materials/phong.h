#pragma once
// Phong's reflection model, modified to conserve energy.

#include "common/materials/scattering.h"

namespace gib {

/// A one-sided model. With alpha the angle between wi and the mirror direction of wo:
///     f = rho_d / pi + rho_s (n + 2) / (2 pi) cos(alpha)^n                (Lafortune and Willems 1994, equation 8)
/// At normal incidence the second (glossy) lobe reflects rho_s; at other angles it reflects less, because a part of
/// it lies below the surface. Its samples have the density (n + 1) / (2 pi) cos(alpha)^n (ibid., equation 12); those
/// below the surface are rejected, so that pdf_w integrates to less than 1. Lobes are chosen in proportion to their
/// mean reflectance. The glossy lobe is classified by the roughness sqrt(2 / (n + 2)) of a Beckmann distribution of
/// about its width.
struct Phong {
    Color diffuse_reflectance = Color::Constant(0.5f);
    Color specular_reflectance = Color::Constant(0.2f);
    float exponent = 30.f;  ///< n, from 0 to highest_exponent
    /// Above this exponent the lobe is too narrow for directions in single precision.
    static constexpr float highest_exponent = 1e8f;

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    /// The coefficient of the glossy lobe is an upper bound.
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    LobeKind glossy_kind() const { return kind_of_roughness(std::sqrt(2.f / (exponent + 2.f))); }
    /// The probability of sampling the glossy lobe; empty if there is nothing to sample.
    std::optional<float> glossy_probability(Lobes which) const;
};

}  // namespace gib
