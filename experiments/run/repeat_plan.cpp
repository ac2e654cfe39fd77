#include "experiments/run/repeat_plan.h"

#include "common/core/error.h"

namespace gib {

bool RepeatPlan::has_cells_of(const std::string& scene, const std::string& method) const {
    for (int seed = 1; seed <= experiment.seeds; ++seed)
        if (passes.count(cell_folder_name(scene, method, static_cast<std::uint64_t>(seed))) > 0) return true;
    return false;
}

std::string RepeatPlan::reference_of(const std::string& scene) const {
    const auto found = references.find(scene);
    return found == references.end() ? "" : found->second;
}

void RepeatPlan::check_scene(const ExperimentScene& scene, const std::string& content_hash) const {
    const auto then = scene_hashes.find(scene.name);
    if (then != scene_hashes.end() && then->second != content_hash)
        throw InputError(
            {scene.path},
            "the scene was changed since the run (the file itself, or one that it uses): its images cannot "
            "be repeated");
}

}  // namespace gib
