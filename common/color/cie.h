#pragma once
// Converts spectra to linear RGB as the CIE 1931 2-degree observer sees them. The integrals are the sums of Mitsuba
// 3's RGB variants, so that a scene with spectra has the same colours in both programs.

#include "common/core/math.h"

#include <functional>
#include <vector>

namespace gib {

/// The range of wavelengths that the observer sees [nm]; spectra count as 0 outside.
inline constexpr double shortest_wavelength = 360;
inline constexpr double longest_wavelength = 830;

/// The integral of the colour matching function y over the wavelength [nm].
inline constexpr double observer_y_integral = 106.7502593994140625;

/// The colour matching functions x, y and z at a wavelength [nm], interpolated linearly between multiples of 5 nm.
Colord cie_1931_xyz(double wavelength);

/// The relative power of CIE's standard illuminant D65 at a wavelength [nm], interpolated linearly between
/// multiples of 5 nm. It is scaled so that a surface of reflectance 1 has luminance 1 under it (up to
/// 0.1 %, see rgb_of_spectrum).
double cie_d65(double wavelength);

/// Linear RGB with sRGB's primaries and white point (ITU-R BT.709). The white of equal energy, whose x, y and z are
/// all 1, is reddish.
Colord rgb_of_xyz(const Colord& xyz);

/// A quantity as a function of the wavelength [nm].
using Spectrum = std::function<double(double)>;

/// A spectrum given by samples: linear between them, 0 before the first and after the last.
struct SampledSpectrum {
    std::vector<double> wavelengths;  ///< [nm], increasing, at least two
    std::vector<double> values;
    double operator()(double wavelength) const;
};

/// The light by which a spectrum is multiplied before the conversion. A reflectance takes `d65`, so that one that is
/// the same at all wavelengths becomes grey.
enum class Illuminant { none, d65 };

/// Linear RGB of a spectrum; a channel is negative if the primaries cannot mix the colour. The integral is Mitsuba's:
/// a sum over 1000 wavelengths, both ends of the range included, each with a weight of 1/1000 of the range, divided
/// by 106.7502593994140625, which is the same sum for y. D65 was scaled with a different sum, so that a reflectance
/// of 1 at all wavelengths becomes 0.9989.
Colord rgb_of_spectrum(const Spectrum& spectrum, Illuminant illuminant);

}  // namespace gib
