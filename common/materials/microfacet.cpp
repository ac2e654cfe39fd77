#include "common/materials/microfacet.h"

#include <algorithm>

namespace gib {

namespace {

constexpr double inv_sqrt_pi = std::numbers::inv_sqrtpi;

/// The middle of the interval of length 2^-24 that a random number stands for: neither 0 nor 1.
double middle(float u) { return static_cast<double>(u) + 0x1p-25; }

/// An estimate of gaussian_slope with a relative error of 2e-3. Source: Winitzki 2008, "A handy approximation for the
/// error function and its inverse". `tail` = erfc(|x|).
double gaussian_slope_estimate(double tail) {
    constexpr double a = 0.147;
    const double l = std::log(tail * (2 - tail));
    const double b = 2 / (std::numbers::pi * a) + 0.5 * l;
    return std::sqrt(std::max(std::sqrt(b * b - l / a) - b, 0.0));
}

/// Solves (1 + erf(x)) / 2 = u for x, 0 < u < 1.
double gaussian_slope(double u) {
    const double tail = 2 * std::min(u, 1 - u);  // without the cancellation of 1 - erf
    double x = gaussian_slope_estimate(tail);
    for (int step = 0; step < 2; ++step) {  // each of Halley's steps triples the digits
        const double newton = (tail - std::erfc(x)) / (2 * inv_sqrt_pi * std::exp(-x * x));
        x -= newton / (1 + newton * x);
    }
    return u < 0.5 ? -x : x;
}

/// Samples the slope t towards a viewer at (cos, sin) to the normal of a Beckmann surface of roughness 1. Its
/// density is proportional to (cos - t sin) exp(-t^2) for t < cot. The integral of the density (Heitz and d'Eon
/// 2014, supplement), multiplied by sin so that it has limits both at grazing angles and at normal incidence, is
/// N(t) = cos (1 + erf(t)) / 2 + sin exp(-t^2) / (2 sqrt(pi)). Halley's method inside a shrinking bracket solves
/// N(t) = u N(cot).
double beckmann_visible_slope(double cos_theta, double sin_theta, double u) {
    constexpr double limit = 6;  // exp(-36): the density beyond it is negligible
    const auto integral = [&](double t, double gauss) {
        return 0.5 * (cos_theta * std::erfc(-t) + sin_theta * inv_sqrt_pi * gauss);
    };
    double lower = -limit, upper = cos_theta < limit * sin_theta ? cos_theta / sin_theta : limit;
    const double target = u * integral(upper, std::exp(-upper * upper));
    // The iteration starts between the solutions for cos = 0 and for sin = 0, but not at the upper end, where the
    // density is 0 and the steps would stall.
    const double grazing = -std::sqrt(-std::log(u));
    const double frontal = std::copysign(gaussian_slope_estimate(2 * std::min(u, 1 - u)), u - 0.5);
    double t = std::min(sin_theta * sin_theta * grazing + cos_theta * cos_theta * frontal, upper - 0.05);
    for (int step = 0; step < 60; ++step) {
        const double gauss = std::exp(-t * t), facing = cos_theta - t * sin_theta;
        const double excess = integral(t, gauss) - target;
        (excess > 0 ? upper : lower) = t;
        const double newton = excess / (inv_sqrt_pi * facing * gauss);
        const double change = newton / (1 + newton * (t + 0.5 * sin_theta / facing));
        if (std::abs(change) < 1e-6) return t - change;  // the remaining error is of the order of its cube
        t = t - change > lower && t - change < upper ? t - change : 0.5 * (lower + upper);
    }
    return t;
}

/// A visible normal of the stretched surface, of any length; wo_std is a unit vector. Dupuy and Benyoub 2023,
/// "Sampling Visible GGX Normals with Spherical Caps": mirror directions are uniform on the cap z > -wo.z. The height
/// of a mirror direction over the cap's edge and its distance from the axis are written as products, so that nothing
/// cancels near either end.
Vec3 ggx_visible_normal(const Vec3& wo_std, const Vec2& u) {
    const float above = 1.f + wo_std.z();
    const float below = (sqr(wo_std.x()) + sqr(wo_std.y())) / above;  // 1 - wo.z
    const float h = (1.f - u.y()) * above;                            // z + wo.z
    const float radius = std::sqrt(u.y() * above * (h + below));      // (1 - z) (1 + z)
    const float phi = 2.f * pi * u.x();
    return {radius * std::cos(phi) + wo_std.x(), radius * std::sin(phi) + wo_std.y(), h};
}

Vec3 beckmann_visible_normal(const Vec3& wo_std, const Vec2& u) {
    const float s = std::hypot(wo_std.x(), wo_std.y());
    const Vec2 towards = s > 0.f ? Vec2(wo_std.x() / s, wo_std.y() / s) : Vec2(1.f, 0.f);
    const auto along = static_cast<float>(-beckmann_visible_slope(wo_std.z(), s, middle(u.x())));
    const auto across = static_cast<float>(gaussian_slope(middle(u.y())));
    return {along * towards.x() - across * towards.y(), along * towards.y() + across * towards.x(), 1.f};
}

/// Corrects the rounded length of a unit vector with one Newton step for 1 / sqrt. Near the horizon the sum of two
/// directions is much shorter than either of them, and the errors of their lengths would decide its direction.
Vec3d with_exact_length(const Vec3& w) {
    const Vec3d d = w.cast<double>();
    return d * (1.5 - 0.5 * d.squaredNorm());
}

}  // namespace

float MicrofacetDistribution::density(const Vec3& m) const {
    if (!(m.z() > 0.f)) return 0.f;
    const float r2 = sqr(m.x() / along_u()) + sqr(m.y() / along_v());
    const float scale = inv_pi / (along_u() * along_v());
    if (type == MicrofacetType::ggx) return scale / sqr(r2 + sqr(m.z()));
    const float z2 = sqr(m.z());
    // Beyond this the density is below 1e-34 of its peak; the formula would multiply an overflow by an underflow.
    if (r2 > 80.f * z2) return 0.f;
    return scale * std::exp(-r2 / z2) / sqr(z2);
}

float MicrofacetDistribution::visible_area(const Vec3& w) const {
    const float s2 = sqr(along_u() * w.x()) + sqr(along_v() * w.y());
    const float c = w.z();
    if (type == MicrofacetType::ggx) return 0.5f * (c + std::sqrt(sqr(c) + s2));
    const float s = std::sqrt(s2);
    if (c >= 4.f * s) return c;  // exp(-16) is below the rounding error
    const float a = c / s;
    return 0.5f * (c * (1.f + std::erf(a)) + s * static_cast<float>(inv_sqrt_pi) * std::exp(-a * a));
}

Vec3 MicrofacetDistribution::sample_visible(const Vec3& wo, const Vec2& u) const {
    const Vec3 wo_std = Vec3(along_u() * wo.x(), along_v() * wo.y(), wo.z()).normalized();
    const Vec3 m_std = type == MicrofacetType::ggx ? ggx_visible_normal(wo_std, u) : beckmann_visible_normal(wo_std, u);
    return Vec3(along_u() * m_std.x(), along_v() * m_std.y(), m_std.z()).normalized();
}

Refraction refracted(const Vec3& wo, const Vec3& m, float cos_o, float cos_i, float eta_ti) {
    const float length = std::abs((eta_ti - 1.f) * (eta_ti + 1.f)) / (cos_o + eta_ti * cos_i);
    return {(std::copysign(length, 1.f - eta_ti) * m - wo).normalized(), length};
}

Facet reflecting_facet(const Vec3& wo, const Vec3& wi) {
    const Vec3d h = with_exact_length(wo) + with_exact_length(wi);
    const double length = h.norm();
    // wo.h = 1 + wo.wi = |h|^2 / 2.
    const auto cosine = static_cast<float>(0.5 * length);
    return {.m = (h / length).cast<float>(), .cos_o = cosine, .cos_i = cosine, .jacobian = reflection_jacobian};
}

std::optional<Facet> refracting_facet(const Vec3& wo, const Vec3& wi, float eta_ti) {
    const Vec3d o = with_exact_length(wo), i = with_exact_length(wi);
    Vec3d h = o + static_cast<double>(eta_ti) * i;
    if (h.z() < 0) h = -h;
    const double length = h.norm();
    if (!(h.z() > 0)) return std::nullopt;
    const auto cos_o = static_cast<float>(o.dot(h) / length), cos_i = static_cast<float>(-i.dot(h) / length);
    if (!(cos_o > 0.f && cos_i > 0.f)) return std::nullopt;
    return Facet{.m = (h / length).cast<float>(),
                 .cos_o = cos_o,
                 .cos_i = cos_i,
                 .jacobian = refraction_jacobian(cos_o, cos_i, eta_ti, static_cast<float>(length))};
}

}  // namespace gib
