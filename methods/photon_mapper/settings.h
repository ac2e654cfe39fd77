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
    std::size_t caustic_k;          ///< photons in an estimate of the caustic map, or all_photons
    std::size_t volume_k;           ///< photons in an estimate of the volume map, or all_photons
    double radius;                  ///< largest look-up radius in the global map [scene diagonals]
    double caustic_radius;          ///< largest look-up radius in the caustic map [scene diagonals]
    double volume_radius;           ///< largest look-up radius in the volume map [scene diagonals]
    Kernel kernel;
    DiscArea area;
    int max_edges;           ///< edges of the longest path
    int direct_samples = 1;  ///< eye paths for emission and direct light, of each pixel in each pass
    bool compensation;       ///< bias compensation: an estimate uses fewer than k photons where more would blur
    bool projection;         ///< lights emit photons only where these can reach surfaces that matter
    int gather = 0;          ///< rays of a final gather; 0: indirect light comes from the global map
    GatherSource source = GatherSource::irradiance;
    bool cache = false;  ///< gathered irradiance is interpolated between the records of a cache
    CacheSettings records = {};
    ShadowPhotonSettings shadows = {};
};

/// The parameters `area` and `projection`, which photon_mapper and progressive_photon_mapper share.
Parameter disc_area_parameter();
Parameter projection_parameter();

}  // namespace gib
