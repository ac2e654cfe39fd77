#pragma once
// The photon mapper's settings and start, apart from its entry in the registry, so that tests can force every pass to
// run.

#include "methods/method.h"
#include "methods/photon_mapper/settings.h"

namespace gib {

/// k = auto: 50 at 1e5 photons and growing as photons^(2/3), at least 4. The bias of an estimate falls with r^2 ~ k / N
/// and its variance with 1 / k; this power lets both vanish as N grows.
std::size_t automatic_k(std::uint64_t photons);

/// Traces the photons and builds the maps for `effects`; the rest of what `settings` could do is not run.
std::unique_ptr<Run> start_photon_mapper(const Scene& scene, const PhotonMapperSettings& settings,
                                         const Effects& effects, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
