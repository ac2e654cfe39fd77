#pragma once
// Fresnel reflectances of smooth interfaces, exact (without Schlick's approximation).

#include "common/core/math.h"

#include <optional>

namespace gib {

/// Reflection and refraction of light that arrives at a smooth dielectric interface at cos_i (signed: >
/// 0 from outside).
struct DielectricFresnel {
    float reflectance;  ///< unpolarised, 1 at total internal reflection
    float cos_t;        ///< cosine of the transmitted ray, its sign opposite to cos_i; 0 at total internal reflection
    float eta_ti;       ///< index on the transmitted side over index on the incident side
};

/// Unpolarised reflectance from the cosines on both sides of the interface, both >= 0 and related by Snell's law; not
/// both 0.
inline float dielectric_reflectance(float cos_i, float cos_t, float eta_ti) {
    const float r_s = (cos_i - eta_ti * cos_t) / (cos_i + eta_ti * cos_t);
    const float r_p = (eta_ti * cos_i - cos_t) / (eta_ti * cos_i + cos_t);
    return 0.5f * (r_s * r_s + r_p * r_p);
}

/// `eta` = interior index / exterior index. Total internal reflection is the limit of the same formula, not a special
/// case of it: cos_t -> 0 gives reflectance -> 1. Source: Born and Wolf, Principles of Optics, section 1.5.2.
/// Inlined, since a call would return two of the numbers in one register, which waits until both are stored.
[[gnu::always_inline]] inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
    const float eta_ti = cos_i >= 0.f ? eta : 1.f / eta;
    const float c = std::abs(cos_i);
    // cos_t^2 = 1 - (1 - c^2) / eta^2, in two forms: the first loses no digits of a small c where eta is nearly 1,
    // the second none of a small 1 - c.
    const float cos_t = c < 0.7f ? safe_sqrt((eta_ti - 1.f) * (eta_ti + 1.f) + c * c) / eta_ti
                                 : safe_sqrt(1.f - (1.f - c) * (1.f + c) / (eta_ti * eta_ti));
    if (cos_t == 0.f) return {1.f, 0.f, eta_ti};
    return {dielectric_reflectance(c, cos_t, eta_ti), cos_i >= 0.f ? -cos_t : cos_t, eta_ti};
}

/// Reflectance of a conductor with index eta + i k relative to the medium outside, per channel, at cos_i in [0, 1].
/// Source: Lagarde 2013, "Memo on Fresnel equations", conductor-dielectric, unpolarised.
inline Color fresnel_conductor(float cos_i, const Color& eta, const Color& k) {
    const float cos2 = cos_i * cos_i, sin2 = 1.f - cos2;
    const Color eta2 = eta * eta, k2 = k * k;
    const Color t0 = eta2 - k2 - sin2;
    const Color a2_plus_b2 = (t0 * t0 + 4.f * eta2 * k2).sqrt();
    const Color a = (0.5f * (a2_plus_b2 + t0)).max(0.f).sqrt();
    const Color t1 = a2_plus_b2 + cos2;
    const Color t2 = 2.f * cos_i * a;
    const Color r_s = (t1 - t2) / (t1 + t2);
    const Color t3 = cos2 * a2_plus_b2 + sin2 * sin2;
    const Color t4 = t2 * sin2;
    // For eta = k = 0 and normal incidence both t3 and t4 are zero. Everything is reflected there, as it is at every
    // other angle.
    const Color sum = t3 + t4;
    const Color r_p = r_s * (sum > 0.f).select((t3 - t4) / sum.max(std::numeric_limits<float>::min()), Color::Ones());
    return 0.5f * (r_s + r_p);
}

}  // namespace gib
