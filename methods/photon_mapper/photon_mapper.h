#pragma once
// The start of the photon mapper and its rule for k. They stand apart from the method's entry in the registry, so
// that tests can force every pass to run.

#include "methods/method.h"
#include "methods/photon_mapper/settings.h"

namespace gib {

/// The value of k=auto for this number of photons N: 50 at 1e5 photons, growing as N^(2/3), at least 4. The bias of
/// an estimate falls with r^2 ~ k / N and its variance with 1 / k; with this power both vanish as N grows.
std::size_t automatic_k(std::uint64_t photons);

/// Traces the photons, builds the maps and returns the run. Only the passes that `effects` call for run, whatever
/// `settings` would allow.
std::unique_ptr<Run> start_photon_mapper(const Scene& scene, const PhotonMapperSettings& settings,
                                         const Effects& effects, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
