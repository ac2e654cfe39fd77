#include "methods/parts/density/kernel.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {
constexpr float gaussian_cut = 0.13533528f;  // exp(-1 / (2 gaussian_sigma^2))
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

}  // namespace gib
