#pragma once
// Plastics: a diffuse base under a clear coat. The coat reflects some of the light. The rest enters, is scattered by
// the base, and either leaves or is reflected back by the coat from inside, to be scattered again. The sum over all
// rounds is (Mitsuba 3's `plastic` and `roughplastic`)
//     f_base = T(wo) T(wi) rho / (pi eta^2 (1 - rho R))
// where T is the share of light that the coat transmits, R the share of diffuse light that it reflects back inside,
// rho the reflectance of the base and eta = coat's index / index outside. Without `nonlinear` the rho beside R is 1:
// light that is reflected back is not absorbed again, and colours keep their hue. One-sided.

#include "common/materials/rough_scattering.h"

#include <memory>
#include <vector>

namespace gib {

/// The share of diffuse light, radiance equal from all directions, that a smooth interface reflects: the integral of
/// F(cos) 2 cos dcos. `eta_ti` = index on the transmitted side over index on the side of the light. Error below 1e-6.
float diffuse_fresnel_reflectance(float eta_ti);

/// Plastic with a smooth coat: T = 1 - F. The coat lets in the share (1 - R) eta^2 of diffuse light from outside. A
/// white base therefore returns all the light that the coat does not reflect, and no energy is lost.
struct Plastic {
    float eta = 1.f;  ///< index of the coat / index outside
    Color diffuse_reflectance = Color::Constant(0.5f);
    Color specular_reflectance = Color::Ones();
    bool nonlinear = false;

    /// Must be called once eta is set.
    void prepare();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

private:
    float internal_reflectance_ = 0.f;
};

/// Transmittance and reflectance of a rough coat, for light that is scattered once.
struct RoughCoat {
    RoughCoat(const MicrofacetDistribution& distribution, float eta);

    /// T: the share of light from cos_o > 0 that the coat refracts. It is linear between nodes at equal distances of
    /// the cosine, and accurate to 1e-4 at the nodes.
    float transmittance(float cos_o) const;

    std::vector<float> nodes;     ///< values of the transmittance at the nodes
    float internal_reflectance;   ///< R as Mitsuba 3 computes it: see RoughPlastic
    float diffuse_transmittance;  ///< the share of diffuse light from outside that is refracted
};

/// Plastic with a rough coat, which reflects like a rough dielectric. T and R are tabulated and hold for single
/// scattering. As in Mitsuba 3, R is the plain mean of 2 cos R(cos) over 64 cosines from 0 to 1, both ends included,
/// which is below the integral: at alpha 1e-4 the base is darker than under a smooth coat by 2.6 % at eta 1.49, 5.7 %
/// at 2 and 11 % at 3. This bias is accepted, as files must look the same in both programs. A white base loses this
/// share of the light, and more under a rougher coat, which also loses light that it scatters several times. R is
/// limited so that no light is gained (the plain mean would gain 1 % at eta 5.7). The distribution is isotropic:
/// alpha_u counts for both axes.
struct RoughPlastic {
    float eta = 1.f;  ///< index of the coat / index outside, above 1
    MicrofacetDistribution distribution;
    Color diffuse_reflectance = Color::Constant(0.5f);
    Color specular_reflectance = Color::Ones();
    bool nonlinear = false;

    /// Must be called once eta and the distribution are set, before any other function. Takes about 0.1 s.
    void prepare();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

    const std::shared_ptr<const RoughCoat>& coat() const { return coat_; }

private:
    std::shared_ptr<const RoughCoat> coat_;
};

}  // namespace gib
