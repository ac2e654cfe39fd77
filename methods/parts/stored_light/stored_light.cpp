#include "methods/parts/stored_light/stored_light.h"

#include "methods/method.h"

namespace gib {

StoredLight Run::stored_light() const { return {}; }

void StoredLight::add(std::string_view name, const PhotonMap& map, std::uint64_t emitted) {
    if (map.size() == 0) return;
    StoredPhotons stored{.map = name, .unit = map.unit(), .photons = {}, .emitted = emitted};
    stored.photons.reserve(map.size());
    for (std::size_t i = 0; i < map.size(); ++i)
        stored.photons.push_back(map[i]);
    photons.push_back(std::move(stored));
}

void StoredLight::add(const PhotonWalkResult& walk) {
    if (!walk.photons.empty())
        photons.push_back({.map = "volume", .unit = walk.unit, .photons = walk.photons, .emitted = walk.emitted});
    if (walk.beams.empty()) return;
    beams.emitted = walk.emitted;
    for (const PhotonBeam& beam : walk.beams)
        beams.beams.push_back({beam.p, beam.end(), static_cast<float>(walk.unit) * beam.power()});
}

}  // namespace gib
