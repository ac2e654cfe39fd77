#include "experiments/metrics/robust_error.h"

#include "common/core/math.h"

#include <limits>
#include <numeric>

namespace gib {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> errors_of_pixels(const Image& x, const Image& r, const Image& r_total, double epsilon) {
    std::vector<double> errors(x.pixels(), 0.0);
    for (std::size_t i = 0; i < x.rgb.size(); ++i) {
        const double error2 = sqr(double{x.rgb[i]} - double{r.rgb[i]});
        errors[i / 3] += error2 / (sqr(double{r_total.rgb[i]}) + epsilon) / 3;
    }
    return errors;
}

bool all_finite(const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

}  // namespace

RobustError robust_error(const std::vector<Image>& replicates, const Image& reference, const Image& r_total,
                         double epsilon) {
    const std::size_t pixels = reference.pixels();
    const std::size_t kept = pixels - (pixels + pixels_per_outlier - 1) / pixels_per_outlier;
    RobustError result{0, 0, nan};
    double worst = 0, all = 0;
    for (const Image& x : replicates) {
        std::vector<double> errors = errors_of_pixels(x, reference, r_total, epsilon);
        if (!all_finite(errors)) return {nan, nan, nan};
        result.median += median_of(errors);
        const auto first_worst = errors.begin() + static_cast<std::ptrdiff_t>(kept);
        std::nth_element(errors.begin(), first_worst, errors.end());
        // The errors that are kept are added up directly, because the total less the worst would cancel.
        const double left = std::accumulate(errors.begin(), first_worst, 0.0);
        const double outliers = std::accumulate(first_worst, errors.end(), 0.0);
        result.trimmed += kept > 0 ? left / static_cast<double>(kept) : nan;
        worst += outliers;
        all += left + outliers;
    }
    const auto count = static_cast<double>(replicates.size());
    result.median /= count;
    result.trimmed /= count;
    if (all > 0) result.share = worst / all;
    return result;
}

}  // namespace gib
