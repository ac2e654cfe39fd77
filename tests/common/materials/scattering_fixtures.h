#pragma once
// Fixtures of the tests of scattering models: directions, integrals over the sphere, shares of light by sampling.

#include "common/materials/microfacet.h"
#include "common/materials/scattering.h"
#include "common/sampling/sampler.h"

#include <gtest/gtest.h>
#include <array>
#include <numbers>
#include <string>
#include <vector>

namespace gib {

inline Vec3 direction_at(double degrees, double phi) {
    const double theta = degrees * std::numbers::pi / 180;
    return Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)).cast<float>();
}

inline Vec3 mirrored_direction(const Vec3& w) { return {-w.x(), -w.y(), w.z()}; }

/// The integral of f over the sphere by the midpoint rule in polar coordinates around `axis`. The rings are narrower
/// near the axis: (1 - cos theta) / 2 = t^3, with uniform steps of t.
template <typename F>
double sphere_integral(const Vec3& axis, F&& f, int rings = 600, int sectors = 240) {
    const Frame frame(axis.normalized());
    double sum = 0;
    for (int r = 0; r < rings; ++r) {
        const double t = (r + 0.5) / rings, half_versine = t * t * t;
        const double cos_theta = 1 - 2 * half_versine, sin_theta = 2 * std::sqrt(half_versine * (1 - half_versine));
        double ring = 0;
        for (int s = 0; s < sectors; ++s) {
            const double phi = 2 * std::numbers::pi * (s + 0.5) / sectors;
            const Vec3d w(sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta);
            ring += static_cast<double>(f(Vec3(frame.to_world(w.cast<float>()).normalized())));
        }
        sum += ring * 6 * t * t;
    }
    return sum / rings * 2 * std::numbers::pi / sectors;
}

/// All lobes together.
template <typename Model>
Color f_of(const Model& m, const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) {
    return m.f_local(wo, wi, transport).sum();
}

/// The direction on the other side of the surface.
inline Vec3 behind(const Vec3& w) { return {w.x(), w.y(), -w.z()}; }

template <typename Model>
double density_integral(const Model& m, const Vec3& wo) {
    return sphere_integral(mirrored_direction(wo), [&](const Vec3& wi) { return m.pdf_w_local(wo, wi, Lobes::all); });
}

template <typename Model>
double reflected_integral(const Model& m, const Vec3& wo, int channel = 0) {
    return sphere_integral(mirrored_direction(wo),
                           [&](const Vec3& wi) { return wi.z() > 0 ? f_of(m, wo, wi)[channel] * wi.z() : 0.f; });
}

inline void expect_color(const Color& found, const Color& expected, float tolerance, const std::string& name) {
    EXPECT_TRUE(((found - expected).abs() <= tolerance * std::max(expected.maxCoeff(), 1e-3f)).all()) << name;
}

constexpr std::array<MicrofacetType, 2> microfacet_types = {MicrofacetType::beckmann, MicrofacetType::ggx};

struct SampledShare {
    double weight = 0;  ///< mean of f |cos| / pdf_w, first channel
    double valid = 0;   ///< the share of the samples that are not empty
};

/// Samples the model at 2^16 stratified points: one in each of 64 x 32 x 32 boxes of the number that chooses the lobe
/// and the two that choose the direction. A jump of the weight crosses some 3000 boxes, each with a variance of at
/// most 1/4, so the standard error is below 4e-4.
template <typename Model>
SampledShare sampled_share(const Model& model, const Vec3& wo, Transport transport = Transport::power,
                           Lobes which = Lobes::all) {
    constexpr std::uint32_t n = 1u << 16;
    SampledShare share;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Sampler jitter(PointSet::independent, 3, 7, i);
        const Vec2 j = jitter.get_2d(1);
        const auto within = [](std::uint32_t box, std::uint32_t boxes, float u) {
            return std::min((static_cast<float>(box) + u) / static_cast<float>(boxes), 1.f - unit_roundoff);
        };
        const Vec2 u(within(i % 32, 32, j.x()), within(i / 32 % 32, 32, j.y()));
        if (const auto s = model.sample_local(wo, within(i / 1024, 64, jitter.get_1d(0)), u, transport, which)) {
            share.weight += double{s->f[0] * std::abs(s->wi.z()) / s->pdf_w};
            share.valid += 1;
        }
    }
    share.weight /= n;
    share.valid /= n;
    return share;
}

}  // namespace gib
