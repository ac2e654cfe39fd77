#pragma once
// From spectra to linear RGB as the CIE 1931 2-degree observer sees them, with the sums of Mitsuba 3's RGB variants: a
// scene with spectra must get the same colours in both.

#include "common/core/math.h"

#include <functional>
#include <vector>

namespace gib {

/// What the observer sees [nm]; spectra are 0 outside.
inline constexpr double shortest_wavelength = 360;
inline constexpr double longest_wavelength = 830;

/// The colour matching functions x, y and z at a wavelength [nm], linear between the multiples of 5 nm.
Colord cie_1931_xyz(double wavelength);

/// The power of CIE's standard illuminant D65 at a wavelength [nm], linear between the multiples of 5 nm. Relative: a
/// surface of reflectance 1 under it has luminance 1 (up to 0.1 %, see rgb_of_spectrum).
double cie_d65(double wavelength);

/// Linear RGB with sRGB's primaries and white point (ITU-R BT.709). An equal-energy white (1, 1, 1) is reddish.
Colord rgb_of_xyz(const Colord& xyz);

/// A quantity as a function of the wavelength [nm].
using Spectrum = std::function<double(double)>;

/// Straight lines between samples, 0 before the first and after the last.
struct SampledSpectrum {
    std::vector<double> wavelengths;  ///< [nm], increasing, at least two
    std::vector<double> values;
    double operator()(double wavelength) const;
};

/// The light that a spectrum is multiplied with: `d65` for a reflectance, so that the eye sees a grey one as grey.
enum class Illuminant { none, d65 };

/// Linear RGB; a channel is below 0 for colours that the primaries cannot mix. The integral is Mitsuba's sum over 1000
/// wavelengths, both ends included, each with a share of 1/1000 of the range, and its scale 106.7502593994140625 is the
/// integral of y by that sum. The scale of D65 is of another sum: a reflectance of 1 at all wavelengths becomes 0.9989.
Colord rgb_of_spectrum(const Spectrum& spectrum, Illuminant illuminant);

}  // namespace gib
