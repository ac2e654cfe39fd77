#pragma once
// Scattering models without roughness: ideal diffuse reflection and smooth interfaces. The latter scatter into single
// directions: they have samples, but neither f nor a density.

#include "common/color/conductor_index.h"
#include "common/materials/scattering.h"
#include "common/sampling/warp.h"

namespace gib {

/// Ideal diffuse reflection: f = reflectance / pi above the surface, one-sided.
struct Diffuse {
    Color reflectance;

    LobeTraits traits() const { return {.diffuse = !is_black(reflectance)}; }
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport) const {
        LobeValues f;
        if (wo.z() > 0.f && wi.z() > 0.f) f.diffuse = reflectance * inv_pi;
        return f;
    }
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
        return wo.z() > 0.f && which != Lobes::specular ? cosine_hemisphere_pdf(wi.z()) : 0.f;
    }
    std::optional<BsdfSample> sample_local(const Vec3& wo, float, const Vec2& u, Transport, Lobes which) const {
        if (wo.z() <= 0.f || which == Lobes::specular || is_black(reflectance)) return std::nullopt;
        std::optional<BsdfSample> sample(std::in_place);  // assigned member by member, as a copy of it takes longer
        sample->wi = square_to_cosine_hemisphere(u);
        sample->f = reflectance * inv_pi;
        sample->pdf_w = cosine_hemisphere_pdf(sample->wi.z());
        sample->lobe = LobeKind::diffuse;
        return sample;
    }
    ScatteringCoefficients coefficients_local(const Vec3& wo) const {
        ScatteringCoefficients c;
        if (wo.z() > 0.f) c.diffuse = reflectance;
        return c;
    }
};

/// A smooth interface between two dielectrics; `eta` = interior index / exterior index.
struct Dielectric {
    float eta = 1.f;
    float cauchy_b = 0.f;  ///< [um^2], B of Cauchy's formula over the exterior index; see dispersion.h
    Color specular_reflectance = Color::Ones();
    Color specular_transmittance = Color::Ones();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3&, const Vec3&, Transport) const { return {}; }
    float pdf_w_local(const Vec3&, const Vec3&, Lobes) const { return 0.f; }
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;
};

/// A thin sheet of a dielectric. Reflections between the two faces are summed up without absorption: R' = R + T R T
/// (1 + R^2 + ...) = 2 R / (1 + R). `eta` = index of the sheet / index around it. Transmitted light goes straight on, as
/// if through a hole: it is no sample, but the share straight_on() of the light (Bsdf::straight_on_local()).
struct ThinDielectric {
    float eta = 1.f;
    Color specular_reflectance = Color::Ones();
    Color specular_transmittance = Color::Ones();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3&, const Vec3&, Transport) const { return {}; }
    float pdf_w_local(const Vec3&, const Vec3&, Lobes) const { return 0.f; }
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;
    /// The reflectance R' of the whole sheet.
    float reflectance(float cos_theta) const;
    /// The share of light that goes straight on, from either side.
    Color straight_on(float cos_theta) const { return specular_transmittance * (1.f - reflectance(cos_theta)); }
};

/// A smooth conductor, one-sided. Without an index (material "none") it is a perfect mirror.
struct Conductor {
    std::optional<ConductorIndex> index;
    Color specular_reflectance = Color::Ones();

    LobeTraits traits() const;
    LobeValues f_local(const Vec3&, const Vec3&, Transport) const { return {}; }
    float pdf_w_local(const Vec3&, const Vec3&, Lobes) const { return 0.f; }
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport, Lobes which) const;
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;
    Color reflectance(float cos_theta) const;
};

}  // namespace gib
