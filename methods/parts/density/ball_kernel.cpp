#include "methods/parts/density/ball_kernel.h"

#include "common/sampling/warp.h"

#include <algorithm>
#include <cmath>

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
