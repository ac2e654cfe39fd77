#pragma once
// The settings of the photon mapper, as plain data.

#include "methods/parts/gathering/cached_gather.h"
#include "methods/photon_mapper/shadow_photons.h"

namespace gib {

struct PhotonMapperSettings {
    std::uint64_t photons;          ///< emitted for the global map
    std::uint64_t caustic_photons;  ///< emitted for the caustic map
    std::uint64_t volume_photons;   ///< emitted for the volume map
    std::size_t k;                  ///< photons in an estimate of the global map, or all_photons
    std::size_t caustic_k;          ///< the same of the caustic map
    std::size_t volume_k;           ///< the same of the volume map
    double radius;                  ///< largest look-up radius in the global map, as a fraction of the scene's diagonal
    double caustic_radius;          ///< the same in the caustic map
    double volume_radius;           ///< the same in the volume map
    Kernel kernel;
    DiscArea area;
    int max_edges;
    bool compensation;  ///< fewer photons where more would blur
    bool projection;    ///< photons are emitted where they can reach surfaces that matter
    int gather = 0;     ///< rays of a final gather; 0: indirect light comes from the global map
    GatherSource source = GatherSource::irradiance;
    bool cache = false;  ///< what is gathered is interpolated
    CacheSettings records = {};
    ShadowPhotonSettings shadows = {};
};

}  // namespace gib
