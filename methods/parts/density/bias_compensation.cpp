#include "methods/parts/density/bias_compensation.h"

#include <cmath>
#include <numbers>

namespace gib {

namespace {

/// The square of the deviation, in standard deviations, up to which discs agree (derivation:
/// bias_compensation.h). For the last disc it is kappa^2, 3 standard deviations; choosing a smaller disc costs
/// more noise and needs stronger evidence.
constexpr double kappa = 3.0;
double allowed_deviations2(const NestedDisc& settled, const NestedDisc& last) {
    return kappa * kappa + 2 * std::log(static_cast<double>(last.photons) / static_cast<double>(settled.photons));
}

/// The square of the cube root's deviation from its mean, in units of its variance.
double deviations2(const NestedDisc& small, const NestedDisc& large) {
    const auto i = static_cast<double>(small.photons), j = static_cast<double>(large.photons);
    if (!(small.weight > 0)) return 0;  // without light in the small disc there is nothing to compare
    const double ratio = (large.weight * (j + 1) / j / large.area) / (small.weight * (i + 1) / i / small.area);
    const double q = j * large.squared_weight / (large.weight * large.weight);
    const double variance = q / 9 * (1 / i - 1 / j);
    const double deviation = std::cbrt(ratio) - (1 - variance);
    return deviation * deviation / variance;
}

}  // namespace

std::size_t next_disc(std::size_t photons) {
    return static_cast<std::size_t>(std::ceil(static_cast<double>(photons) * std::numbers::sqrt2));
}

std::size_t largest_agreeing_disc(std::span<const NestedDisc> discs) {
    for (std::size_t large = 1; large < discs.size(); ++large)
        for (std::size_t small = 0; small < large; ++small)
            if (deviations2(discs[small], discs[large]) > allowed_deviations2(discs[large - 1], discs.back()))
                return large - 1;
    return discs.size() - 1;
}

}  // namespace gib
