#pragma once
// Complex indices of refraction of metals and other materials, by the names that Mitsuba's conductors accept.

#include "common/core/math.h"

#include <optional>
#include <string_view>
#include <vector>

namespace gib {

struct ConductorIndex {
    Color eta;  ///< real part
    Color k;    ///< imaginary part
};

/// The index of a material: the RGB values of the spectra that Mitsuba has under this name (its data/ior: from the
/// Luxpop database, after Palik, Handbook of Optical Constants of Solids, and the scattering factors of CXRO and
/// LLNL). They are computed by rgb_of_spectrum() without an illuminant, as Mitsuba computes them; only for an eta or
/// k that a scene file lists itself does Mitsuba use D65. Ag, Al, Au, Cr, Cu and W, and eta of AlSb, Cu_palik, Ta and
/// ThF4, are integrated from those data. The others are the means of the same data in Tungsten's ComplexIorData.hpp;
/// where both were compared, they differ by less than 0.1 % (Cu's red: 0.3 %). Empty if there is no such material.
std::optional<ConductorIndex> conductor_index(std::string_view name);

/// All names, for error messages.
std::vector<std::string_view> conductor_names();

}  // namespace gib
