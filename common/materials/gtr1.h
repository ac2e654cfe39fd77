#pragma once
// The generalised Trowbridge-Reitz distribution of exponent 1, the clear coat's facets in the principled model. Source:
// Burley 2012, "Physically Based Shading at Disney", appendix B.

#include "common/core/math.h"

namespace gib {

/// D(m) = (alpha^2 - 1) / (pi ln(alpha^2) (1 + (alpha^2 - 1) m.z^2)) [1/sr], so that the integral of D(m) m.z is 1.
struct Gtr1 {
    float alpha;  ///< above 0, below 1

    /// For m.z > 0.
    float density(const Vec3& m) const {
        // With s^2 = 1 - m.z^2, the denominator 1 + (alpha^2 - 1) m.z^2 is s^2 + alpha^2 m.z^2: nothing cancels.
        const float sine2 = sqr(m.x()) + sqr(m.y());
        return (1.f - sqr(alpha)) / (-2.f * pi * std::log(alpha) * (sine2 + sqr(alpha * m.z())));
    }
    /// A normal with density D(m) m.z. In t = sin^2 the density is that of 1 / (t + alpha^2 (1 - t)), whose integral
    /// is a logarithm: t + alpha^2 (1 - t) = alpha^(2 (1 - u)).
    Vec3 sample(const Vec2& u) const {
        const float alpha2 = sqr(alpha);
        // alpha^(2 (1 - u)) - alpha^2 = alpha^2 (alpha^(-2 u) - 1), without cancellation near the pole.
        const float sine2 = std::min(alpha2 * std::expm1(-2.f * u.y() * std::log(alpha)) / (1.f - alpha2), 1.f);
        const float sine = std::sqrt(sine2), phi = 2.f * pi * u.x();
        return {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(std::max(1.f - sine2, 1e-12f))};
    }
};

}  // namespace gib
