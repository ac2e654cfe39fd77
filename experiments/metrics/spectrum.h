#pragma once
// At which spatial frequencies the error of a method lies.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <vector>

namespace gib {

struct SpectrumPoint {
    double frequency;  ///< [cycles per pixel], the ring's mean
    double power;      ///< white noise of unit variance = 1 (noise); [radiance^2] with the same scaling (bias)
};

struct NoiseSpectrum {
    std::vector<SpectrumPoint> curve;  ///< radial, 0 to sqrt(1/2)
    double centroid;   ///< [cycles per pixel], over the two-dimensional spectrum without DC; white: 0.3826
    double low_ratio;  ///< share of the power below 0.1 cycles per pixel as a multiple of white noise's
};

/// Of the replicates' scatter around their mean, channels averaged, scaled to variance 1. Empty with fewer than 3
/// replicates, or where nothing scatters.
std::optional<NoiseSpectrum> noise_spectrum(const std::vector<Image>& replicates, const Image& reference);

/// Real part of the cross-spectrum of two independent halves of (mean of replicates - reference). Empty without two
/// replicates and two groups of the reference.
std::vector<SpectrumPoint> bias_spectrum(const std::vector<Image>& replicates, const ReferenceLayer& reference);

}  // namespace gib
