#pragma once
// Microfacet theory of rough surfaces: the distribution of the facets' normals, the share of facets that is visible
// from a direction, and the facet that takes light from one direction to another. The local frame has z along the
// mean normal.
//
// Sources: Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; Heitz 2014, "Understanding
// the Masking-Shadowing Function in Microfacet-Based BRDFs" (JCGT 3(2)); Heitz and d'Eon 2014, "Importance Sampling
// Microfacet-Based BSDFs using the Distribution of Visible Normals".

#include "common/core/components.h"
#include "common/core/math.h"

#include <optional>

namespace gib {

enum class MicrofacetType {
    beckmann,  ///< a surface with Gaussian heights
    ggx        ///< Trowbridge-Reitz: longer tails
};

/// The distribution of slopes is P22(x, y) = p((x / alpha_u)^2 + (y / alpha_v)^2) / (alpha_u alpha_v) with p(r^2) =
/// exp(-r^2) / pi for Beckmann and 1 / (pi (1 + r^2)^2) for GGX. Stretching the surface by 1 / alpha turns every
/// distribution into the isotropic one of roughness 1 (Heitz 2014, section 5.3); it multiplies x and y of directions
/// by alpha.
struct MicrofacetDistribution {
    MicrofacetType type = MicrofacetType::beckmann;
    /// Roughness along x and y; for Beckmann with equal values, the root mean square slope. Values below min_alpha
    /// act as min_alpha, as in Mitsuba 3: narrower lobes are equal in single precision, and the smooth
    /// models are meant for a roughness of 0.
    float alpha_u = 0.1f, alpha_v = 0.1f;

    static constexpr float min_alpha = 1e-4f;

    /// D(m) [1/sr] for a unit vector m: the area of facets per unit of macroscopic area and of solid angle, so that
    /// the integral of D(m) m.z is 1. Zero for m.z <= 0. Walter et al. 2007, equations 25 and 33, for two alphas.
    float density(const Vec3& m) const;

    /// The area of facets that is visible along w, as seen from there and per unit of macroscopic area: the integral
    /// of max(w.m, 0) D(m), which is w.z / G1(w) (Heitz 2014, equations 13 and 43). Smith's masking is exact here (no
    /// rational fit as in Walter et al.), and the area stays positive at w.z = 0, where w.z / G1(w) would be 0 / 0.
    /// For w.z >= 0.
    float visible_area(const Vec3& w) const;

    /// Smith's masking function G1: the visible share of the facets that face w. For w.z >= 0.
    float g1(const Vec3& w) const { return w.z() / visible_area(w); }

    /// A normal with density max(wo.m, 0) D(m) / visible_area(wo). For wo.z > 0 and u in [0, 1)^2.
    Vec3 sample_visible(const Vec3& wo, const Vec2& u) const;

    float roughness() const { return std::max(alpha_u, alpha_v); }

private:
    float along_u() const { return std::max(alpha_u, min_alpha); }
    float along_v() const { return std::max(alpha_v, min_alpha); }
};

/// The facet that takes light from wi to wo.
struct Facet {
    Vec3 m;          ///< its unit normal, m.z > 0
    float cos_o;     ///< wo.m > 0
    float cos_i;     ///< |wi.m|
    float jacobian;  ///< wo.m times the solid angle of m over that of wi; it stays finite at wo.m = 0
};

/// The direction that a facet mirrors wo into; cos_o = wo.m.
inline Vec3 reflected(const Vec3& wo, const Vec3& m, float cos_o) { return (2.f * cos_o * m - wo).normalized(); }

/// The direction that a facet refracts wo into; cos_i = |wi.m| > 0 by Snell's law. wo + eta_ti wi points along m. Its
/// length |cos_o - eta_ti cos_i| is computed as |eta_ti^2 - 1| / (cos_o + eta_ti cos_i), where nothing cancels.
struct Refraction {
    Vec3 wi;
    float length;  ///< length of wo + eta_ti wi
};
Refraction refracted(const Vec3& wo, const Vec3& m, float cos_o, float cos_i, float eta_ti);

/// The jacobian of a facet that reflects.
inline constexpr float reflection_jacobian = 0.25f;

/// The jacobian of a facet that refracts.
inline float refraction_jacobian(float cos_o, float cos_i, float eta_ti, float length) {
    return cos_o * cos_i * sqr(eta_ti / length);
}

/// The facet that mirrors wo into wi, for wo.z > 0 and wi.z > 0. Walter et al. 2007, equations 13 and 14.
Facet reflecting_facet(const Vec3& wo, const Vec3& wi);

/// The facet that refracts wo into wi, for wo.z > 0 and wi.z < 0. `eta_ti` = index on wi's side over index on wo's
/// side, not 1. Empty if there is no such facet. Walter et al. 2007, equations 16 and 17.
std::optional<Facet> refracting_facet(const Vec3& wo, const Vec3& wi, float eta_ti);

}  // namespace gib
