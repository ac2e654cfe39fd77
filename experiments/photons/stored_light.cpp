#include "experiments/photons/stored_light.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/sampling/sampler.h"
#include "common/scene/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace gib {

namespace {

/// More lines than these would cover each other.
constexpr std::size_t most_beams = 50000;

/// The value of a radius: the number of the label, the default, or what the run has measured; empty if there is none.
std::optional<double> radius_of(const ConfiguredMethod& method,
                                const std::vector<std::pair<std::string, std::string>>& facts,
                                const std::string& name) {
    for (const auto& [fact, value] : facts)
        if (fact == name) return number_from<double>(value);
    for (const Parameter& parameter : method.description.parameters)
        if (parameter.name == name) return number_from<double>(method.values.text(name));
    return std::nullopt;
}

}  // namespace

std::vector<std::size_t> even_shares(const std::vector<std::size_t>& counts, std::size_t places) {
    std::vector<std::size_t> order(counts.size()), shares(counts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return counts[a] < counts[b]; });
    std::size_t groups = counts.size();
    for (const std::size_t group : order) {
        shares[group] = std::min(counts[group], places / groups);
        places -= shares[group];
        --groups;
    }
    return shares;
}

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
        light.beams.emitted += stored.beams.emitted;
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
    const std::size_t beams = light.stored_beams = stored.beams.beams.size();
    const std::size_t shown = std::min({beams, most_beams, work.most_photons});
    for (std::size_t i = 0; i < beams; ++i)
        if (is_at_step(i, beams, shown)) light.beams.beams.push_back(stored.beams.beams[i]);
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
    map->emitted += stored.emitted;
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

ShownImage shown_image(const ShownImageWork& work) {
    const auto chosen = work.method.create({work.scene.max_edges});
    const MeasureWork cell{.scene = *work.scene.scene,
                           .method = *chosen,
                           .seed = work.seed,
                           .spp = work.passes,
                           .budget = {},
                           .only_last = true};
    ShownImage estimate;
    const auto keep = [&](const Checkpoint&, const ComponentImages& components) { estimate.image = components; };
    const Measurement measured = measure(cell, keep, {}, work.observer);
    estimate.passes = measured.checkpoints.back().passes;
    estimate.emitted = measured.checkpoints.back().counts.photons;
    for (const auto& [map, name] : {std::pair("global", "radius"), {"caustic", "caustic_radius"}})
        if (const auto share = radius_of(work.method, measured.facts, name))
            estimate.radii[map] = *share * double{work.scene.scene->diagonal()};
    for (const Parameter& parameter : work.method.description.parameters)
        if (parameter.name == "k") estimate.k = work.method.values.number_unless_word("k");
    if (chosen->plan(*work.scene.scene).runs("final gathering")) estimate.gather = work.method.values.integer("gather");
    return estimate;
}

PixelGrid::PixelGrid(int image_width, int image_height, int most) : width(image_width), height(image_height) {
    const double share = std::min(std::sqrt(double(most) / (double(width) * height)), 1.0);
    columns = std::clamp(static_cast<int>(share * width), 1, most);
    rows = std::clamp(static_cast<int>(share * height), 1, most / columns);
}

}  // namespace gib
