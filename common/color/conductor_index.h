#pragma once
// Complex indices of refraction of metals and other materials, by the names that Mitsuba's conductors know.

#include "common/core/math.h"

#include <optional>
#include <string_view>
#include <vector>

namespace gib {

struct ConductorIndex {
    Color eta;  ///< real part
    Color k;    ///< imaginary part
};

/// RGB means of the spectra that Mitsuba has under these names (its data/ior: from the Luxpop database, after Palik,
/// Handbook of Optical Constants of Solids, and the CXRO's and LLNL's scattering factors), by the sum of cie.h without
/// an illuminant, which is how Mitsuba reads them; it takes the D65 for an eta or k that a scene file lists itself.
/// Ag, Al, Au, Cr, Cu and W, and eta of AlSb, Cu_palik, Ta and ThF4, are integrated from those data; the others are the
/// means of the same data in Tungsten's ComplexIorData.hpp, which differ by less than 0.1 % (Cu's red: 0.3 %) where
/// both were compared. Empty: no such material.
std::optional<ConductorIndex> conductor_index(std::string_view name);

/// For messages.
std::vector<std::string_view> conductor_names();

}  // namespace gib
