#pragma once
// Light split by wavelength where light has three channels.
//
// Model of spectral transport: the visible range is cut into strata of equal width, each of which stands for its middle
// wavelength. Light of colour c is white light, by D65, that a filter without bands coloured: in a stratum it is c
// times the stratum's weight, and the mean of the weights is 1 in each channel. Until a path meets a surface whose
// index depends on the wavelength all strata behave alike and are followed together; there it takes one of them, each
// with probability 1 / wavelength_strata, its throughput is multiplied by the weight, and it keeps the stratum. So the
// mean over paths is unbiased in this model. What joins two subpaths that were both split counts only those of equal
// strata, wavelength_strata times, and one of the two weights.

#include "common/core/math.h"

namespace gib {

inline constexpr int wavelength_strata = 32;

/// The middle of a stratum [nm], counted from 0 at the short end: 400 to 700 nm in equal parts.
double stratum_wavelength(int stratum);

/// The share of white light in a stratum by channel, as linear sRGB shows it, times wavelength_strata. Wavelengths that
/// the primaries cannot mix have negative channels; those are 0 here, and each channel is scaled to a mean of 1.
const Color& stratum_weight(int stratum);

/// The lines of Fraunhofer that indices and Abbe's number refer to [nm].
inline constexpr double c_line = 656.2725, d_line = 587.5618, f_line = 486.1327;

/// Cauchy's formula n = A + B / wavelength^2 with n = `index` at the d line; `b` in um^2, `wavelength` in nm.
double cauchy_index(double index, double b, double wavelength);

/// The B of Cauchy's formula [um^2] for Abbe's number (n_d - 1) / (n_F - n_C).
double cauchy_b_of_abbe(double index, double abbe);

}  // namespace gib
