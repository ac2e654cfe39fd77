#pragma once
// Light that a run keeps in the scene and not in its image: photons, irradiance records, patches, a field that paths have
// learned. It is for display only; no estimate reads it.

#include "methods/parts/photons/photon.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace gib {

struct StoredPhotons {
    std::string_view map;  ///< "global", "caustic" or "volume"
    double unit;           ///< meaning of a power of 1 [W]; in media of power over sigma_s [W x scene unit]
    std::vector<Photon> photons;
    std::uint64_t emitted = 0;  ///< number of photons emitted for the map
};

/// The photon beams of a walk through media.
struct StoredBeams {
    struct Beam {
        Vec3 from, to;
        Color power;  ///< at its beginning [W]
    };
    std::vector<Beam> beams;
    std::uint64_t emitted = 0;  ///< number of photons emitted for them
};

/// A record of an irradiance cache.
struct StoredRecord {
    Vec3 p;
    Vec3 n;        ///< unit, on the side that is lit
    float radius;  ///< a R_i of irradiance_cache.h, within which the record serves points of its normal [scene units]
    Color irradiance;  ///< [W/m^2]
};

/// The patches of radiosity, which share their corners.
struct StoredPatches {
    std::vector<Vec3> corners;
    std::vector<Color> radiosity;                       ///< B [W/m^2] by corner, emission left out
    std::vector<std::array<std::uint32_t, 4>> patches;  ///< in turn around the patch; a triangle has its last twice
};

/// The light that a run stores after the passes so far: Run::stored_light().
struct StoredLight {
    std::vector<StoredPhotons> photons = {};  ///< a map each; maps that are not made or are empty are left out
    StoredBeams beams = {};
    std::vector<StoredRecord> records = {};
    StoredPatches patches = {};
    bool changes_with_passes = false;  ///< a further pass stores other light: new photons, or a better solution
    bool is_of_one_pass = false;       ///< photons and beams are those of the last pass alone

    bool empty() const { return photons.empty() && beams.beams.empty() && records.empty() && patches.patches.empty(); }
};

}  // namespace gib
