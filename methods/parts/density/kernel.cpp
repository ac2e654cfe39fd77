#include "methods/parts/density/kernel.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {
constexpr float gaussian_cut = 0.13533528f;  // exp(-1 / (2 gaussian_sigma^2))

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

double kernel_weight(Kernel kernel, float d2, float r) {
    const double r2 = sqr(double{r}), s2 = double{d2} / r2;
    const double per_area = std::numbers::inv_pi / r2;
    switch (kernel) {
        case Kernel::uniform:
            return per_area;
        case Kernel::cone:
            return 3 * std::max(1 - std::sqrt(s2), 0.0) * per_area;
        case Kernel::gaussian:
            return std::exp(-s2 / (2 * sqr(double{gaussian_sigma}))) /
                   (2 * sqr(double{gaussian_sigma}) * (1 - double{gaussian_cut})) * per_area;
        case Kernel::epanechnikov:
            return 2 * std::max(1 - s2, 0.0) * per_area;
    }
    return 0;
}

float kernel_mass(Kernel kernel, float s) {
    switch (kernel) {
        case Kernel::uniform:
            return s * s;
        case Kernel::cone:
            return s * s * (3.f - 2.f * s);
        case Kernel::gaussian:
            return -std::expm1(-sqr(s / gaussian_sigma) / 2.f) / (1.f - gaussian_cut);
        case Kernel::epanechnikov:
            return s * s * (2.f - s * s);
    }
    return 0.f;
}

float kernel_radius(Kernel kernel, float u) {
    switch (kernel) {
        case Kernel::uniform:
            return std::sqrt(u);
        case Kernel::cone:
            return 0.5f - std::sin(std::asin(1.f - 2.f * u) / 3.f);  // 3 s^2 - 2 s^3 = u
        case Kernel::gaussian:
            return gaussian_sigma * std::sqrt(-2.f * std::log1p(-u * (1.f - gaussian_cut)));
        case Kernel::epanechnikov:
            return std::sqrt(1.f - std::sqrt(1.f - u));  // 2 s^2 - s^4 = u
    }
    return 0.f;
}

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

}  // namespace gib
