#pragma once
// The settings of the photon mapper, its start and its rule for k. They stand apart from the method's entry in the
// registry, so that tests can force every pass to run.

#include "methods/parts/gathering/cached_gather.h"
#include "methods/parts/photon_mapping/photon_maps.h"
#include "methods/parts/shadow_photons/shadow_photons.h"

namespace gib {

struct PhotonMapperSettings : PhotonMapSettings {
    int direct_samples = 1;  ///< eye paths for emission and direct light, of each pixel in each pass
    int gather = 0;          ///< rays of a final gather; 0: indirect light comes from the global map
    GatherSource source = GatherSource::irradiance;
    bool cache = false;                ///< gathered irradiance is interpolated between the records of a cache
    float accuracy = 0.15f;            ///< of the cache
    std::uint64_t shadow_photons = 0;  ///< emitted; 0: lights are chosen without them
};

/// The value of k=auto for this number of photons N: 50 at 1e5 photons, growing as N^(2/3), at least 4. The bias of
/// an estimate falls with r^2 ~ k / N and its variance with 1 / k; with this power both vanish as N grows.
std::size_t automatic_k(std::uint64_t photons);

/// Traces the photons, builds the maps and returns the run. Only the steps that `effects` call for run, whatever
/// `settings` would allow.
std::unique_ptr<Run> start_photon_mapper(const Scene& scene, const PhotonMapperSettings& settings,
                                         const Effects& effects, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
