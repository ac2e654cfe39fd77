#pragma once
// The settings of the photon mapper, as plain data.

#include "methods/parts/gathering/cached_gather.h"
#include "methods/parts/photon_mapping/photon_maps.h"
#include "methods/parts/shadow_photons/shadow_photons.h"

namespace gib {

struct PhotonMapperSettings : PhotonMapSettings {
    int direct_samples = 1;  ///< eye paths for emission and direct light, of each pixel in each pass
    bool compensation;       ///< bias compensation: an estimate uses fewer than k photons where more would blur
    int gather = 0;          ///< rays of a final gather; 0: indirect light comes from the global map
    GatherSource source = GatherSource::irradiance;
    bool cache = false;  ///< gathered irradiance is interpolated between the records of a cache
    CacheSettings records = {};
    ShadowPhotonSettings shadows = {};
};

}  // namespace gib
