#include "experiments/metrics/epsilon.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// Mean luminance over the pixels [W/(sr m^2)]; 0 without pixels.
double mean_luminance(const Image& image) {
    double sum = 0;
    for (std::size_t p = 0; p < image.pixels(); ++p)
        sum += double{luminance(image.at(p))};
    return sum / static_cast<double>(std::max<std::size_t>(image.pixels(), 1));
}

}  // namespace

double epsilon_of(const std::optional<double>& given, const Image& r) {
    if (given) return *given;
    const double epsilon = sqr(relative_epsilon_share * mean_luminance(r));
    // A reference that is not finite has no epsilon, and no error that is a number.
    return std::isfinite(epsilon) ? std::clamp(epsilon, smallest_epsilon, largest_epsilon) : epsilon;
}

}  // namespace gib
