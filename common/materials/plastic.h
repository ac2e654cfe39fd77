#pragma once
// A diffuse base under a clear coat: some of the light is reflected by the coat, the rest goes in, is scattered by the
// base, and goes out or is thrown back from inside to be scattered again. Summed up over all rounds (Mitsuba 3's
// `plastic` and `roughplastic`):
//     f_base = T(wo) T(wi) rho / (pi eta^2 (1 - rho R))
// where T is what the coat lets through, R the share of diffuse light from inside that it throws back, rho the
// reflectance of the base and eta = coat's index / index outside. Without `nonlinear` the rho beside R is 1: what is
// thrown back is not absorbed, and colours keep their hue. One-sided.

#include "common/materials/rough_scattering.h"

#include <memory>
#include <vector>

namespace gib {

/// The share of diffuse light, radiance equal from all directions, that a smooth interface reflects: the integral of
/// F(cos) 2 cos dcos. `eta_ti` = index on the transmitted side over index on the side of the light. Error below 1e-6.
float diffuse_fresnel_reflectance(float eta_ti);

/// Under a smooth coat: T = 1 - F. As (1 - R) eta^2 is the share of diffuse light that the coat lets in, a white base
/// scatters all light that is not reflected before: nothing is lost.
struct Plastic {
    float eta = 1.f;  ///< index of the coat / index outside
    Color diffuse_reflectance = Color::Constant(0.5f);
    Color specular_reflectance = Color::Ones();
    bool nonlinear = false;

    /// To be called when eta is set.
    void prepare();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    float internal_reflectance_ = 0.f;
};

/// What a rough coat does with light that it scatters once.
struct RoughCoat {
    RoughCoat(const MicrofacetDistribution& distribution, float eta);

    /// T: the share of light from cos_o > 0 that the coat refracts; linear between nodes at equal distances of the
    /// cosine, and accurate to 1e-4 there.
    float transmittance(float cos_o) const;

    std::vector<float> nodes;     ///< of the transmittance
    float internal_reflectance;   ///< R as Mitsuba 3 has it, see below
    float diffuse_transmittance;  ///< the share of diffuse light from outside that is refracted
};

/// Under a rough coat, whose own reflection is that of a rough dielectric. T and R are of single scattering and kept in
/// a table. Mitsuba 3 takes R as the plain mean of 2 cos R(cos) over 64 cosines from 0 to 1, both ends included, which
/// is below the integral: at alpha 1e-4 the base is darker than under a smooth coat by 2.6 % at eta 1.49, 5.7 % at 2
/// and 11 % at 3. That is kept, as files must look the same in both; a white base loses that much of the light, and
/// more under a rougher coat, whose light of several scatterings is lost. R is never so low that light is gained (1 %
/// at eta 5.7). The distribution is isotropic: alpha_u counts for both axes.
struct RoughPlastic {
    float eta = 1.f;  ///< index of the coat / index outside, above 1
    MicrofacetDistribution distribution;
    Color diffuse_reflectance = Color::Constant(0.5f);
    Color specular_reflectance = Color::Ones();
    bool nonlinear = false;

    /// To be called when eta and the distribution are set, before anything else. Takes about 0.1 s.
    void prepare();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    std::shared_ptr<const RoughCoat> coat_;
};

}  // namespace gib
