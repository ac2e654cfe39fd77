#pragma once
// A uniform subset of the photons of several maps and passes, in memory that does not grow with the number of photons.
//
// Each photon gets a random number, and the photons with the least numbers are kept (bottom-k sampling). Every subset
// of this size is equally likely, whatever the order in which photons arrive.

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

}  // namespace gib
