#pragma once
// What tests of scattering models share: directions, integrals over the sphere, shares of light by sampling.

#include "common/sampler.h"
#include "common/scattering.h"

#include <numbers>

namespace gib {

inline Vec3 direction_at(double degrees, double phi) {
    const double theta = degrees * std::numbers::pi / 180;
    return Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)).cast<float>();
}

inline Vec3 mirrored_direction(const Vec3& w) { return {-w.x(), -w.y(), w.z()}; }

/// The integral over the sphere by the midpoint rule in polar coordinates around `axis`, whose rings crowd there:
/// (1 - cos theta) / 2 = t^3.
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

struct SampledShare {
    double weight = 0;  ///< mean of f |cos| / pdf_w, first channel
    double valid = 0;   ///< the share of the samples that are not empty
};

/// With 2^16 Sobol' points: the error of smooth integrands is below 1e-3.
template <typename Model>
SampledShare sampled_share(const Model& model, const Vec3& wo, Transport transport = Transport::power,
                           Lobes which = Lobes::all) {
    constexpr std::uint32_t n = 1u << 16;
    SampledShare share;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Sampler u(PointSet::sobol, 3, 7, i);
        if (const auto s = model.sample_local(wo, u.get_1d(0), u.get_2d(1), transport, which)) {
            share.weight += static_cast<double>(s->f[0] * std::abs(s->wi.z()) / s->pdf_w);
            share.valid += 1;
        }
    }
    share.weight /= n;
    share.valid /= n;
    return share;
}

}  // namespace gib
