#pragma once
// Diffuse reflection of a rough surface, such as clay or dust.

#include "common/materials/scattering.h"

namespace gib {

/// Oren and Nayar 1994, "Generalization of Lambert's Reflectance Model", one-sided: facets that reflect diffusely, in long
/// V-shaped grooves whose slopes have a Gaussian distribution. With interreflection f is the sum of equations 30 and 31;
/// without it (`fast`) it is equation 32, the qualitative model. As in Mitsuba 0.6, the distribution's standard deviation
/// sigma is alpha / sqrt(2), where alpha is the roughness of Beckmann's distribution. Where very rough surfaces (alpha
/// above 1) would have a negative f, it is 0. Samples follow the cosine.
struct RoughDiffuse {
    Color reflectance = Color::Constant(0.5f);  ///< of a facet
    float alpha = 0.2f;
    bool fast = false;

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    /// An estimate: the reflectance of a facet.
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;
};

}  // namespace gib
