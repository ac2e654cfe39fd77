#include "methods/parts/stored_light/stored_light.h"

#include "methods/method.h"

namespace gib {

StoredLight Run::stored_light() const { return {}; }

void StoredLight::add(std::string_view name, const PhotonMap& map) {
    if (map.size() == 0) return;
    StoredPhotons stored{.map = name, .unit = map.unit(), .photons = {}};
    stored.photons.reserve(map.size());
    for (std::size_t i = 0; i < map.size(); ++i)
        stored.photons.push_back(map[i]);
    photons.push_back(std::move(stored));
}

void StoredLight::add(std::string_view name, const std::vector<Photon>& map, double unit) {
    if (!map.empty()) photons.push_back({.map = name, .unit = unit, .photons = map});
}

}  // namespace gib
