#pragma once
// The rule by which photons are joined with an eye path, and the weight of the joined path.

#include "methods/parts/photons/photon.h"
#include "methods/parts/transport/dispersed_path.h"

namespace gib {

/// The part of a path between the eye and the point where photons are looked up.
struct EyePath {
    int max_photon_edges;             ///< largest number of edges of a photon's path, as whole paths are limited
    std::optional<int> stratum = {};  ///< stratum of wavelengths, if the eye path was split

    /// Whether the photon's path may be joined with this one.
    bool accepts(const PhotonPayload& photon) const {
        return photon.edges <= max_photon_edges && can_join(stratum, photon.stratum());
    }
    /// Factor for the photon's power, by channel: see joint_weight().
    Color weight(const PhotonPayload& photon) const { return joint_weight(stratum, photon.stratum()); }
};

}  // namespace gib
