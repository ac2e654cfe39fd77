#pragma once
// The weights of two estimators that both sample one integrand.

#include <cmath>

namespace gib {

/// The weight of the first of two estimators of the same integral, by the power heuristic with beta = 2.
/// Source: Veach 1997, equation 9.13. Infinite densities (delta functions) give the limit of the weight.
inline float power_heuristic(float pdf, float other_pdf) {
    if (!std::isfinite(pdf)) return 1.f;
    if (pdf <= 0.f) return 0.f;
    const float ratio = other_pdf / pdf;  // the squares of the densities might overflow, unlike their ratio
    return 1.f / (1.f + ratio * ratio);
}

}  // namespace gib
