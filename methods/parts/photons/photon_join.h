#pragma once
// Which photons an eye path may be joined with, and with what weight.

#include "methods/parts/photons/photon.h"
#include "methods/parts/transport/dispersed_path.h"

namespace gib {

/// The part of a path from the eye to where photons are looked up.
struct EyePath {
    int max_photon_edges;             ///< photons of longer paths would make a path that is too long
    std::optional<int> stratum = {};  ///< of wavelengths, if the path was split

    bool accepts(const Photon& photon) const {
        return photon.edges <= max_photon_edges && can_join(stratum, photon.stratum());
    }
    Color weight(const Photon& photon) const { return joint_weight(stratum, photon.stratum()); }
};

}  // namespace gib
