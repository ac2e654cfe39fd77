#pragma once
// The spatial frequencies at which the error of a method lies: radial power spectra of its noise and of its bias.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <vector>

namespace gib {

struct SpectrumPoint {
    double frequency;  ///< [cycles per pixel], mean over the ring
    double power;      ///< power of noise: 1 for white noise of variance 1; of bias: [radiance^2] with the same scaling
};

struct NoiseSpectrum {
    std::vector<SpectrumPoint> curve;  ///< radial means, from frequency 0 to sqrt(1/2)
    /// Mean frequency of the two-dimensional spectrum without DC [cycles per pixel]; white noise has 0.3826.
    double centroid;
    /// Share of the power that lies below 0.1 cycles per pixel, over the share that white noise has there.
    double low_ratio;
};

/// The spectrum of the replicates' deviations from their mean, which are averaged over the channels and scaled to
/// variance 1 in every pixel. Empty with fewer than 3 replicates or without noise.
std::optional<NoiseSpectrum> noise_spectrum(const std::vector<Image>& replicates, const Image& reference);

/// The real part of the cross-spectrum of two independent estimates of the bias, (mean of replicates - reference),
/// each from half of the replicates and half of the groups. Empty without two replicates and two groups of the
/// reference.
std::vector<SpectrumPoint> bias_spectrum(const std::vector<Image>& replicates, const ReferenceLayer& reference);

}  // namespace gib
