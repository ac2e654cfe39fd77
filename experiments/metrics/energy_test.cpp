// Notation: n images of p passes and N pixels; X the mean of their energies, a sum of independent contributions x >= 0
// of single samples; R the reference's energy; D = R - X - unsampled the light that is missing.
//
// For contributions that are not negative, P(E X - X >= D) <= exp(-D^2 / (2 sum E x^2)) (Maurer 2003, "A bound on the
// deviation probability for sums of non-negative random variables"). No upper bound of x is needed, but the second
// moments are, and the scatter of the images knows only those of the samples that occurred. Let x <= s for all samples.
// Contributions that are too rare to occur have the mean energy D at most, so that their second moments add s D at
// most:
//     D^2 >= z^2 V + 2 ln(1 / alpha) s D
// where V is the variance of X and of R, and z the quantile at alpha. A loss of light is significant only if
// D exceeds 2 ln(1 / alpha) samples of size s: a path tracer that has not found a small lamp yet is not rejected.
//
// s is the larger of two sizes, each as a part of X. (1) Twice the brightest emitted radiance: combined with multiple
// importance sampling, a path brings its throughput times the radiance at most, and roulette and guiding may raise a
// throughput above 1. (2) The largest excess of a pixel over the reference, as if one sample had made it: lights at a
// point have no brightest radiance.
//
// Every sample lights its own pixel alone, so that pixels are independent: the scatter within pixels estimates V with
// thousands of degrees of freedom from two or three images. Methods whose paths light many pixels have no such test,
// because the light of one path has no bound.
#include "experiments/metrics/energy_test.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

namespace {

constexpr double largest_throughput = 2;

/// The mean of the channels of one pixel.
double pixel_energy(const Image& image, std::size_t pixel) {
    return (double{image.rgb[3 * pixel]} + double{image.rgb[3 * pixel + 1]} + double{image.rgb[3 * pixel + 2]}) / 3;
}

/// The variance of the images' mean energy by the scatter within pixels, and the largest excess of a pixel over the
/// reference.
struct PixelScatter {
    double variance = 0, largest_excess = 0;
};

PixelScatter pixel_scatter(const std::vector<Image>& images, const Image& reference) {
    const auto n = static_cast<double>(images.size()), pixels = static_cast<double>(reference.pixels());
    PixelScatter scatter;
    for (std::size_t pixel = 0; pixel < reference.pixels(); ++pixel) {
        double mean = 0, squares = 0;
        for (const Image& image : images)
            mean += pixel_energy(image, pixel) / n;
        for (const Image& image : images) {
            squares += sqr(pixel_energy(image, pixel) - mean);
            scatter.largest_excess =
                std::max(scatter.largest_excess, pixel_energy(image, pixel) - pixel_energy(reference, pixel));
        }
        scatter.variance += squares / (n * (n - 1) * sqr(pixels));
    }
    return scatter;
}

}  // namespace

std::optional<EnergyTest> energy_test(const std::vector<Image>& images, const SampledLight& sampled,
                                      const ReferenceLayer& reference, const EnergyBalance& balance, double unsampled,
                                      double alpha) {
    if (images.size() < 2 || !sampled.brightest) return std::nullopt;
    if (reference.groups.size() < 2 && !reference.standard_error) return std::nullopt;
    const SampleMean truth = reference_energy(reference);
    const double missing = truth.value - balance.energy.value - unsampled;
    const PixelScatter scatter = pixel_scatter(images, reference.mean);
    if (!std::isfinite(missing) || !(scatter.variance > 0)) return std::nullopt;
    const VarianceTerm own{scatter.variance, std::numeric_limits<double>::infinity()};
    const double shares = static_cast<double>(images.size() * reference.mean.pixels());
    const double sample = std::max(largest_throughput * *sampled.brightest / sampled.passes, scatter.largest_excess);
    const double rare = -2 * std::log(alpha) * sample / shares;
    const double square = sqr(half_width({own, truth.variance}, 2 * alpha));
    // The roots of D^2 = square + rare D bound what may be missing by chance.
    const double least = rare / 2 + std::sqrt(sqr(rare / 2) + square);
    EnergyTest test;
    const double excess = balance.excess.value;
    test.excess = {
        excess,
        of_light({excess - std::sqrt(square) / balance.unit, excess + (least + unsampled) / balance.unit}, balance)};
    test.is_rejected = missing > least && missing > unsampled && missing >= balance_least * balance.unit;
    return test;
}

}  // namespace gib
