#include "experiments/photons/collected_light.h"

#include "common/core/reject.h"

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

}  // namespace gib
