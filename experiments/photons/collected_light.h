#pragma once
// Runs a method until the light that it stores is complete, and collects what a page can show of it.

#include "common/reader/scene_file.h"
#include "experiments/photons/photon_subset.h"
#include "methods/method.h"

#include <string>
#include <vector>

namespace gib {

struct StoredLightWork {
    const LoadedScene& scene;
    const ConfiguredMethod& method;
    std::uint64_t seed = 1;
    std::uint32_t most_passes;                               ///< 1 to 255
    std::size_t most_photons;                                ///< number of photons shown
    StageTimes::Listener listener = StageTimes::Listener();  ///< is told of the progress
};

struct CollectedLight {
    std::vector<PhotonSubset::Map> photons;
    std::vector<StoredRecord> records;
    StoredPatches patches;
    std::uint32_t passes = 0;          ///< number of passes made
    bool photons_of_passes = false;    ///< whether each pass has photons of its own
    std::vector<std::string> skipped;  ///< passes of the plan that were not run, with the reasons

    bool empty() const { return photons.empty() && records.empty() && patches.patches.empty(); }
};

/// Throws InputError, which names the methods that store light, if the method is none of them.
void require_stored_light(const MethodLabel& method);

/// Makes passes until a further one would store no other light, at most `most_passes`; none if the start stores all. The
/// photons are those of all passes made, records and patches those after the last.
CollectedLight collect_stored_light(const StoredLightWork& work);

}  // namespace gib
