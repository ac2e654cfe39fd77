#include "methods/parts/density/volume_estimate.h"

#include "common/sampling/warp.h"
#include "methods/parts/density/place_rounding.h"

namespace gib {

namespace {

/// Points of the ball are probed until this many are visible from its centre.
constexpr int probes_in_sight = 8;
/// Largest number of probes, which bounds their time: a point that sees less than a 64th of its ball is
/// estimated too dark.
constexpr int most_probes = 64 * probes_in_sight;

/// Integral of s^2 exp(-s^2 / (2 sigma^2)) from 0 to x, sigma = gaussian_sigma.
double gaussian_moment(double x) {
    const double a = 1 / (2 * sqr(static_cast<double>(gaussian_sigma)));
    return std::sqrt(std::numbers::pi) * std::erf(std::sqrt(a) * x) / (4 * a * std::sqrt(a)) -
           x * std::exp(-a * sqr(x)) / (2 * a);
}

/// The share of the kernel's integral over the ball that lies within s, a fraction of its radius.
double share_within(Kernel kernel, double s) {
    static const double gaussian_total = gaussian_moment(1);
    const double s3 = s * s * s;
    switch (kernel) {
        case Kernel::uniform:
            return s3;
        case Kernel::cone:
            return s3 * (4 - 3 * s);
        case Kernel::gaussian:
            return gaussian_moment(s) / gaussian_total;
        case Kernel::epanechnikov:
            return s3 * (5 - 3 * s * s) / 2;
    }
    return 0;
}

}  // namespace

double ball_kernel_weight(Kernel kernel, float d2, float r) {
    static const double gaussian_norm = 1 / (4 * std::numbers::pi * gaussian_moment(1));
    const double r2 = sqr(double{r}), s2 = double{d2} / r2;
    const double per_r3 = 1 / (r2 * double{r});
    switch (kernel) {
        case Kernel::uniform:
            return 0.75 * std::numbers::inv_pi * per_r3;
        case Kernel::cone:
            return 3 * std::numbers::inv_pi * per_r3 * std::max(1 - std::sqrt(s2), 0.0);
        case Kernel::gaussian:
            return gaussian_norm * per_r3 * std::exp(-s2 / (2 * sqr(double{gaussian_sigma})));
        case Kernel::epanechnikov:
            return 1.875 * std::numbers::inv_pi * per_r3 * std::max(1 - s2, 0.0);
    }
    return 0;
}

float ball_kernel_radius(Kernel kernel, float u) {
    if (kernel == Kernel::uniform) return std::cbrt(u);
    double lower = 0, upper = 1;  // bisection: the share grows with s
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (lower + upper);
        (share_within(kernel, middle) < static_cast<double>(u) ? lower : upper) = middle;
    }
    return static_cast<float>(0.5 * (lower + upper));
}

Scattered VolumeEstimator::scattered_radiance(const PhotonMap& map, RayQueries& rays, const Vec3& p,
                                              const PhaseFunction& phase, const Vec3& wo, const EyePath& eye,
                                              NumberStream& u) const {
    if (!(max_radius > 0.f)) return {};
    const auto scattered = [&](const Photon& photon, float distance2, float r) -> Colord {
        const double scale =
            map.unit() * double{phase.value(wo, photon.direction())} * ball_kernel_weight(kernel, distance2, r);
        return scale * photon.power().cast<double>() * eye.weight(photon).cast<double>();
    };
    float r = max_radius;
    const float narrow_r = estimates_bias ? narrow_radius * r : 0.f;
    Colord sum = Colord::Zero(), narrow = Colord::Zero();
    const auto add_all_within = [&](float radius) {
        map.within(p, radius, [&](const Photon& photon, float distance2) {
            if (!eye.accepts(photon)) return;
            sum += scattered(photon, distance2, radius);
            if (distance2 < sqr(narrow_r)) narrow += scattered(photon, distance2, narrow_r);
        });
    };
    if (k == all_photons) {
        add_all_within(r);
    } else {
        std::vector<Neighbour>& neighbours = neighbours_of_thread();
        map.nearest(
            p, k, max_radius, [&](const Photon& photon, float) { return eye.accepts(photon); }, neighbours);
        std::size_t inside = neighbours.size();
        if (inside == k) r = std::sqrt(neighbours[--inside].distance2);
        const float unresolved = std::min(place_rounding(rays.scene(), p), max_radius);
        if (inside < neighbours.size() && r <= unresolved) {
            r = unresolved;
            add_all_within(r);
        } else if (r > 0.f) {
            for (std::size_t i = 0; i < inside; ++i)
                sum += scattered(map[neighbours[i].index], neighbours[i].distance2, r);
        }
    }
    Scattered light{sum.cast<float>(), estimates_bias ? Color(narrow.cast<float>()) : Color::Zero()};
    if (is_black(light.radiance)) return light;
    if (area == DiscArea::surface) {
        light.radiance *= reciprocal_share_in_sight(kernel, rays, p, r, u);
        if (!is_black(light.bias)) light.bias *= reciprocal_share_in_sight(kernel, rays, p, narrow_r, u);
    }
    if (estimates_bias) light.bias = bias_of_difference * (light.radiance - light.bias);
    return light;
}

float reciprocal_share_in_sight(Kernel kernel, RayQueries& rays, const Vec3& p, float r, NumberStream& u) {
    int in_sight = 0, probes = 0;
    for (; in_sight < probes_in_sight && probes < most_probes; ++probes) {
        const float first = u.next();
        const Vec3 w = square_to_sphere({first, u.next()});
        const float distance = r * ball_kernel_radius(kernel, u.next());
        if (!rays.intersect({.o = p, .d = w, .t_max = distance})) ++in_sight;
    }
    return static_cast<float>(probes) / static_cast<float>(std::max(in_sight, 1));
}

}  // namespace gib
