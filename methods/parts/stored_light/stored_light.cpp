#include "methods/parts/stored_light/stored_light.h"

namespace gib {

void StoredLight::add(std::string_view name, const PhotonMap& map) {
    if (map.size() == 0) return;
    StoredPhotons stored{.map = name, .unit = map.unit(), .photons = {}};
    stored.photons.reserve(map.size());
    for (std::size_t i = 0; i < map.size(); ++i)
        stored.photons.push_back(map[i]);
    photons.push_back(std::move(stored));
}

}  // namespace gib
