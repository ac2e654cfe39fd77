// Notation: n runs i with p_i passes; e_ij the mean energy a pass between two successive checkpoints, which are l_ij passes
// apart; R the reference's energy; D = mean of the final energies - R.
//
// Two or three seeds tell little: Student's t has 2 degrees of freedom. But passes are independent of each other, too, so that
// l_ij (e_ij - mean)^2 estimates the variance sigma^2 of one pass, whether or not pixels share noise. All of them together give
// Var(mean of the final energies) = sigma^2 mean(1 / p_i) / n. Noise that belongs to a whole run would exceed this, so that the
// scatter of the final energies counts where it is larger. Passes that depend on each other as the points of a Sobol' sequence
// scatter less in the sum than alone, which makes the test conservative.
//
// Rare bright light makes energies skewed: most runs are too dark AND scatter too little. Three rules bound what zeros can
// do. (1) If a few parts hold the scatter, it is known as badly as from these few: the degrees of freedom are
// 2 ((sum d^2)^2 / sum d^4 - 1) at most, which is 1 for a single part and 2/3 of their number for normal noise. (2) If the energy
// D is missing because events of the size s were not met, these add the variance D s / (number of trials) to that of the runs.
// s is taken as `unseen_factor` times the largest excess of a pixel over the reference, or as many times the variance over the
// mean of the energies, which is the mean size, weighed by size, of events that light many pixels (compound Poisson process).
// If the images are too bright, the same holds for the reference and its groups. (3) Light in pixels where all images are black
// is not missing, and as much again may be missing where one image alone has met it (Good 1953, "The population frequencies of
// species and the estimation of population parameters").
//
// Simulated with 2 to 5 runs of 4 to 64 passes, 256 pixels, 0.001 to 1 event a pixel and pass (sizes: exponential, lognormal
// with sigma 2 and 3, Pareto with index 1.3 to 2, 1 in 1000 events 300 times brighter) or 0.01 to 3 events a pass that light the
// whole image, right methods are rejected in none of 300 runs each; by (1) and a plain t test in up to 90 %.
#include "experiments/metrics/energy_test.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

namespace {

constexpr double unseen_factor = 2;
constexpr double shown_tail = 0.01;  ///< of the interval, as that of Footing::excess

/// A part of a run between two checkpoints.
struct Part {
    double passes, energy;  ///< energy: mean of these passes
};

std::vector<Part> parts_of(const std::vector<EnergyCurve>& curves) {
    std::vector<Part> parts;
    for (const EnergyCurve& curve : curves) {
        double passes = 0, sum = 0;
        for (const EnergyAfter& after : curve) {
            const double p = after.passes, length = p - passes;
            parts.push_back({length, (p * after.energy - sum) / length});
            passes = p;
            sum = p * after.energy;
        }
    }
    return parts;
}

/// The variance of the mean of the final energies.
VarianceTerm variance_of(const std::vector<EnergyCurve>& curves, const std::vector<Part>& parts,
                         const VarianceTerm& of_seeds) {
    double passes = 0, sum = 0, squares = 0, fourths = 0, inverse = 0;
    for (const Part& part : parts) {
        passes += part.passes;
        sum += part.passes * part.energy;
    }
    for (const Part& part : parts) {
        const double square = part.passes * sqr(part.energy - sum / passes);
        squares += square;
        fourths += sqr(square);
    }
    if (!(fourths > 0)) return {0, 1};
    const auto n = static_cast<double>(curves.size());
    for (const EnergyCurve& curve : curves)
        inverse += 1 / (n * n * curve.back().passes);
    const double degrees = static_cast<double>(parts.size() - 1);
    return {std::max(squares / degrees * inverse, of_seeds.variance),
            std::clamp(2 * (sqr(squares) / fourths - 1), 1.0, degrees)};
}

/// The largest excess of a value over that of the reference's mean, over the number of values: the size of an event as part of the
/// images' mean energy.
double brightest_pixel(const std::vector<Image>& images, const Image& reference) {
    double largest = 0;
    for (const Image& image : images)
        for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
            double excess = 0;
            for (std::size_t k = i; k < i + 3; ++k)
                excess += double{image.rgb[k]} - double{reference.rgb[k]};
            largest = std::max(largest, excess);
        }
    return images.empty() ? 0 : largest / static_cast<double>(images.size() * reference.rgb.size());
}

}  // namespace

std::optional<EnergyTest> energy_test(const std::vector<EnergyCurve>& curves, const std::vector<Image>& images,
                                      const ReferenceLayer& reference, const Footing& footing, double unmet,
                                      double alpha) {
    if (images.size() < 2 || (reference.groups.size() < 2 && !reference.standard_error)) return std::nullopt;
    const SampleMean truth = reference_energy(reference);
    const std::vector<Part> parts = parts_of(curves);
    const VarianceTerm own = variance_of(curves, parts, footing.energy.variance);
    const double difference = footing.energy.value - truth.value;
    if (!std::isfinite(difference) || !std::isfinite(own.variance) || !(own.variance > 0)) return std::nullopt;
    const bool is_darker = difference < 0;
    const auto event_of = [&](const std::vector<Image>& all, double energy, double variance) {
        return unseen_factor * std::max(brightest_pixel(all, reference.mean), energy > 0 ? variance / energy : 0);
    };
    const double event = is_darker ? event_of(images, footing.energy.value, own.variance)
                                   : event_of(reference.groups, truth.value, truth.variance.variance);
    const double least = is_darker ? std::max(0.0, -difference - unmet) : difference;
    const auto half = [&](double tail) {
        return half_width({own, truth.variance, {least * event, std::numeric_limits<double>::infinity()}}, tail);
    };
    const double shown = half(shown_tail), excess = difference / footing.unit;
    EnergyTest test;
    test.excess = {excess,
                   Interval{excess - shown / footing.unit, excess + (shown + (is_darker ? unmet : 0)) / footing.unit}};
    test.is_rejected = least > half(alpha) && (!is_darker || least > unmet) && least >= footing_least * footing.unit;
    return test;
}

}  // namespace gib
