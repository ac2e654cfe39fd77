#include "experiments/photons/collected_light.h"

#include "common/core/reject.h"
#include "common/sampling/sampler.h"
#include "experiments/photons/even_shares.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace gib {

void require_stored_light(const MethodLabel& method) {
    const auto names = names_of_methods_that_store_light();
    if (std::ranges::find(names, method.name) == names.end())
        reject({}, "'{}' stores no photons, irradiance records or patches that could be shown; methods that do: {}",
               method.name, fmt::join(names, ", "));
}

CollectedLight collect_stored_light(const StoredLightWork& work) {
    require_stored_light(work.method.label);
    const auto method = work.method.create({work.scene.max_edges});
    CollectedLight light;
    for (const Plan::Step& step : method->plan(*work.scene.scene).steps)
        if (!step.runs) light.skipped.push_back(fmt::format("{} ({})", step.name, step.reason));
    StageTimes stages;
    if (work.listener) stages.listen(work.listener);
    const auto run = method->start(*work.scene.scene, work.seed, stages);
    PhotonSubset photons(work.most_photons);
    const auto add = [&](const StoredLight& stored, std::uint32_t pass) {
        for (const StoredPhotons& map : stored.photons)
            photons.add(map, pass);
    };
    StoredLight stored = run->stored_light();
    light.photons_of_passes = stored.is_of_one_pass;
    if (!light.photons_of_passes) add(stored, 0);
    while (light.passes < work.most_passes && stored.changes_with_passes) {
        const Progress progress = run->advance(light.passes);
        stored = run->stored_light();
        if (light.photons_of_passes) add(stored, light.passes);
        ++light.passes;
        if (progress == Progress::converged) break;
    }
    light.photons = photons.maps();
    light.records = std::move(stored.records);
    light.patches = std::move(stored.patches);
    return light;
}

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
