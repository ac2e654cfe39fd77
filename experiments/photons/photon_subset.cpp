#include "experiments/photons/photon_subset.h"

#include "common/sampling/sampler.h"
#include "experiments/photons/even_shares.h"

#include <algorithm>

namespace gib {

void PhotonSubset::keep_least(std::vector<Shown>& photons, std::size_t count) {
    if (photons.size() <= count) return;
    const auto end = photons.begin() + static_cast<std::ptrdiff_t>(count);
    std::nth_element(photons.begin(), end, photons.end(),
                     [](const Shown& a, const Shown& b) { return a.number < b.number; });
    photons.erase(end, photons.end());
}

void PhotonSubset::add(const StoredPhotons& stored, std::uint32_t pass) {
    auto map = std::ranges::find_if(maps_, [&](const Map& m) { return m.name == stored.map; });
    if (map == maps_.end()) {
        maps_.push_back({.name = std::string(stored.map), .unit = stored.unit, .shown = {}});
        map = maps_.end() - 1;
    }
    const std::uint64_t key = combine_keys(static_cast<std::uint64_t>(map - maps_.begin()), pass);
    for (std::size_t i = 0; i < stored.photons.size(); ++i) {
        const Photon& photon = stored.photons[i];
        const Color power = photon.power();
        if (power.isFinite().all()) map->power += stored.unit * static_cast<double>(power.mean());
        else ++map->not_finite;
        map->shown.push_back({combine_keys(key, i), photon, pass});
        // The vector is cut only once it is twice as long as needed, so that the cost per photon stays constant.
        if (map->shown.size() >= 2 * most_ + 2) keep_least(map->shown, most_);
    }
    map->stored += stored.photons.size();
}

std::vector<PhotonSubset::Map> PhotonSubset::maps() const {
    std::vector<Map> maps = maps_;
    std::vector<std::size_t> counts;
    for (const Map& map : maps)
        counts.push_back(static_cast<std::size_t>(map.stored));
    const std::vector<std::size_t> shares = even_shares(counts, most_);
    for (std::size_t i = 0; i < maps.size(); ++i) {
        keep_least(maps[i].shown, shares[i]);
        std::ranges::sort(maps[i].shown, [](const Shown& a, const Shown& b) { return a.number < b.number; });
    }
    return maps;
}

}  // namespace gib
