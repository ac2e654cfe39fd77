#pragma once
// Runs a method until the light that it stores is complete, and collects what a page can show of it.
//
// A uniform subset of the photons of several maps and passes, in memory that does not grow with the number of photons.
//
// Each photon gets a random number, and the photons with the least numbers are kept (bottom-k sampling). Every subset
// of this size is equally likely, whatever the order in which photons arrive.

#include "common/reader/scene_file.h"
#include "methods/method.h"
#include "methods/parts/stored_light/stored_light.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

class PhotonSubset {
public:
    /// Keeps at most `most` photons, in even shares of the maps.
    explicit PhotonSubset(std::size_t most) : most_(most) {}

    /// Adds the photons of a map. Those of one pass are added once.
    void add(const StoredPhotons& stored, std::uint32_t pass);

    struct Shown {
        std::uint64_t number;  ///< random
        Photon photon;
        std::uint32_t pass;
    };
    struct Map {
        std::string name;
        std::uint64_t stored = 0;      ///< photons of all passes
        std::uint64_t not_finite = 0;  ///< number of these photons without a finite power
        double power = 0;              ///< sum over photons, mean of the channels [W]
        double unit = 1;               ///< unit of the photons' power [W]
        std::vector<Shown> shown;

        /// [W] of a photon; 0 without photons.
        double mean_power() const { return stored > not_finite ? power / static_cast<double>(stored - not_finite) : 0; }
    };
    /// The maps in the order of their first photons. The photons of a map are in random order.
    std::vector<Map> maps() const;

private:
    static void keep_least(std::vector<Shown>& photons, std::size_t count);

    std::size_t most_;
    std::vector<Map> maps_;
};

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
