#include "common/media/phase.h"

#include "common/sampling/warp.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// The direction at the cosine c from w, whose sine is s, and at the azimuth 2 pi u.
Vec3 turned_from(const Vec3& w, float c, float s, float u) {
    const float phi = 2.f * pi * u;
    return Frame(w).to_world({s * std::cos(phi), s * std::sin(phi), c});
}

/// The cosine c with the density 3 (1 + c^2) / 8, whose distribution function is (c^3 + 3 c + 4) / 8. Its inverse is
/// Cardano's solution of c^3 + 3 c = 2 z with z = 4 u - 2 (Frisvad 2011, "Importance sampling the Rayleigh phase function",
/// JOSA A 28(12)).
float rayleigh_cosine(float u) {
    const double z = 4.0 * double{u} - 2.0, root = std::cbrt(z + std::sqrt(z * z + 1.0));
    return static_cast<float>(std::clamp(root - 1.0 / root, -1.0, 1.0));
}

Vec3 sample_rayleigh(const Vec3& wo, const Vec2& u) {
    const float c = rayleigh_cosine(u.x());
    return turned_from(-wo, c, safe_sqrt(1.f - sqr(c)), u.y());
}

}  // namespace

float PhaseFunction::value(const Vec3& wo, const Vec3& wi) const {
    if (model == Model::rayleigh) return 0.1875f * inv_pi * (1.f + sqr(wo.dot(wi)));
    // 1 + g^2 + 2 g c = (1 - |g|)^2 + 2 |g| (1 +- c), where 1 +- c = |wo +- wi|^2 / 2 does not cancel in the peak.
    const float a = std::abs(g);
    const float squared = g >= 0.f ? (wo + wi).squaredNorm() : (wo - wi).squaredNorm();
    const float denominator = sqr(1.f - a) + a * squared;
    return 0.25f * inv_pi * (1.f - a) * (1.f + a) / (denominator * std::sqrt(denominator));
}

Vec3 PhaseFunction::sample(const Vec3& wo, const Vec2& u) const {
    if (model == Model::rayleigh) return sample_rayleigh(wo, u);
    // c = cos of the scattering angle has a distribution whose inverse is c = (1 + a^2 - s^2) / 2a with s = (1 - a^2)
    // / (1 - a + 2 a u). With v = 1 - u and k = 1 + a - 2 a v this is, without cancellation and for a = 0 too,
    //     1 - c = 2 v (1 - a)^2 (1 + a - a v) / k^2.
    const float a = std::abs(g), v = 1.f - u.x();
    const float k = 1.f + a - 2.f * a * v;
    const float one_minus_cos = std::min(2.f * v * sqr(1.f - a) * (1.f + a - a * v) / sqr(k), 2.f);
    const float sine = safe_sqrt(one_minus_cos * (2.f - one_minus_cos));
    return turned_from(g >= 0.f ? Vec3(-wo) : wo, 1.f - one_minus_cos, sine, u.y());
}

}  // namespace gib
