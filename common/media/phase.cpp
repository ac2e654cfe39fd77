#include "common/media/phase.h"

#include "common/sampling/warp.h"

namespace gib {

float PhaseFunction::value(const Vec3& wo, const Vec3& wi) const {
    // 1 + g^2 + 2 g c = (1 - |g|)^2 + 2 |g| (1 +- c), where 1 +- c = |wo +- wi|^2 / 2 does not cancel in the peak.
    const float a = std::abs(g);
    const float squared = g >= 0.f ? (wo + wi).squaredNorm() : (wo - wi).squaredNorm();
    const float denominator = sqr(1.f - a) + a * squared;
    return 0.25f * inv_pi * (1.f - a) * (1.f + a) / (denominator * std::sqrt(denominator));
}

Vec3 PhaseFunction::sample(const Vec3& wo, const Vec2& u) const {
    // c = cos of the scattering angle has a distribution whose inverse is c = (1 + a^2 - s^2) / 2a with s = (1 - a^2)
    // / (1 - a + 2 a u). With v = 1 - u and k = 1 + a - 2 a v this is, without cancellation and for a = 0 too,
    //     1 - c = 2 v (1 - a)^2 (1 + a - a v) / k^2.
    const float a = std::abs(g), v = 1.f - u.x();
    const float k = 1.f + a - 2.f * a * v;
    const float one_minus_cos = std::min(2.f * v * sqr(1.f - a) * (1.f + a - a * v) / sqr(k), 2.f);
    const float sine = safe_sqrt(one_minus_cos * (2.f - one_minus_cos)), phi = 2.f * pi * u.y();
    const Vec3 turned(sine * std::cos(phi), sine * std::sin(phi), 1.f - one_minus_cos);
    return Frame(g >= 0.f ? Vec3(-wo) : wo).to_world(turned);
}

}  // namespace gib
