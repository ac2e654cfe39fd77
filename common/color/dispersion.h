#pragma once
// Dispersion: light, which has three colour channels, is split by wavelength where an index of refraction
// depends on it.
//
// In this model of spectral transport the visible range is cut into strata of equal width, each of which stands for
// its middle wavelength. Light of colour c is white light (D65) that a filter without narrow bands has coloured: in
// each stratum it is c times the stratum's weight, and the mean of the weights is 1 in each channel. Until a path
// meets a surface whose index depends on the wavelength, all strata behave alike and are followed together. There the
// path takes one stratum, each with probability 1 / wavelength_strata, its throughput is multiplied by the stratum's
// weight, and it keeps the stratum from then on. The mean over paths is therefore unbiased in this model.
//
// Two subpaths that have both taken a stratum are joined only if their strata are equal, which has the probability
// 1 / wavelength_strata. The product of their throughputs is therefore multiplied by wavelength_strata. It is also
// divided by the weight, because both throughputs contain the weight.

#include "common/core/math.h"

namespace gib {

inline constexpr int wavelength_strata = 32;

/// The middle wavelength [nm] of a stratum, counted from 0 at the short end. The strata divide 400 to 700 nm
/// into equal parts.
double stratum_wavelength(int stratum);

/// The weight of a stratum: its part of white light as linear sRGB, times wavelength_strata. The primaries cannot mix
/// the colour of a single wavelength, so that some channels are negative; these are set to 0, and each channel is
/// then scaled to a mean of 1 over the strata.
const Color& stratum_weight(int stratum);

/// Wavelengths [nm] of the Fraunhofer lines to which indices and Abbe numbers refer.
inline constexpr double c_line = 656.2725, d_line = 587.5618, f_line = 486.1327;

/// Cauchy's formula n = A + B / wavelength^2 with n = `index` at the d line; `b` in um^2, `wavelength` in nm.
double cauchy_index(double index, double b, double wavelength);

/// The B of Cauchy's formula [um^2] for `abbe`, the Abbe number (n_d - 1) / (n_F - n_C), with n_d = `index`.
double cauchy_b_of_abbe(double index, double abbe);

}  // namespace gib
