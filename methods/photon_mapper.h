#pragma once
// The photon mapper's settings and start, apart from its entry in the registry, so that tests can force every pass to
// run.

#include "methods/cached_gather.h"
#include "methods/method.h"
#include "methods/shadow_photons.h"

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

/// k = auto: 50 at 1e5 photons and growing as photons^(2/3), at least 4. The bias of an estimate falls with r^2 ~ k / N
/// and its variance with 1 / k; this power lets both vanish as N grows.
std::size_t automatic_k(std::uint64_t photons);

/// Traces the photons and builds the maps for `effects`; the rest of what `settings` could do is not run.
std::unique_ptr<Run> start_photon_mapper(const Scene& scene, const PhotonMapperSettings& settings,
                                         const Effects& effects, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
