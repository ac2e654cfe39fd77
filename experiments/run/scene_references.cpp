// The references of the scenes of an experiment: made, taken from an image, or taken from the run that is repeated.
#include "experiments/measuring/given_reference.h"
#include "experiments/measuring/reference.h"
#include "experiments/plan/reference_methods.h"
#include "experiments/run/cell_queue.h"
#include "experiments/run/repeat_plan.h"
#include "experiments/system/interrupt.h"

#include "common/core/parallel.h"

#include <fmt/format.h>

namespace gib {

void ExperimentRun::make_references() {
    for (auto& scene : scenes_) {
        if (!selected(scene)) continue;
        try {
            make_reference_of(scene);
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& error) {
            scene.failed = true;
            fail(fmt::format("the reference of {}: {}", scene.entry.name, error.what()));
        }
    }
}

void ExperimentRun::make_reference_of(SceneState& scene) {
    if (take_reference_of(scene)) return;
    if (!scene.entry.reference_image.empty()) return take_given_reference(scene);
    const LoadedScene loaded = load(scene.entry);
    if (loaded.content_hash != scene.content_hash) throw RunError("the scene was changed while the experiment ran");
    const std::string path = cached_reference_path(reference_key(scene.content_hash, experiment_.reference_method));
    const ReferenceWork work = reference_work(scene, loaded);
    // The lock is held until the folder has its own name for the file, because another run may replace the file at
    // any time after.
    const FileLock lock = lock_reference(path, [&](const std::string& owner) {
        progress_.message(
            fmt::format("the reference of {}: {} is making it; waiting until it has ended", scene.entry.name, owner));
    });
    FinishedReference finished;
    with_threads(threads_, [&] { finished = make_reference(work, progress_); });
    scene.missing = finished.missing;
    if (!scene.missing.empty()) return;
    scene.reference = finished.identity;
    scene.notes = finished.warnings;
    link_file(path, folder_.reference_image(scene.entry.name));
    progress_.message(fmt::format("reference of {}: relative standard error {:.3g} % (epsilon {:.4g}){}",
                                  scene.entry.name, 100 * finished.relative_error, finished.epsilon,
                                  finished.rounds_added == 0 ? " (stored)" : ""));
    for (const auto& warning : finished.warnings)
        progress_.message("warning: " + warning);
}

ReferenceWork ExperimentRun::reference_work(const SceneState& scene, const LoadedScene& loaded) const {
    const MethodLabel& label = experiment_.reference_method;
    return {.scene = loaded,
            .methods = reference_methods(label),
            .label = label,
            .goal = scene.entry.goal,
            .epsilon = experiment_.epsilon,
            .path = cached_reference_path(reference_key(scene.content_hash, label)),
            .most_own_work = most_own_work_};
}

bool ExperimentRun::take_reference_of(SceneState& scene) {
    if (!options_.repeat) return false;
    const std::string image = options_.repeat->original.reference_image(scene.entry.name);
    const std::string identity = stored_reference_identity(image);
    if (identity.empty() || identity != options_.repeat->reference_of(scene.entry.name)) return false;
    link_file(image, folder_.reference_image(scene.entry.name));
    scene.reference = identity;
    scene.notes = stored_notes(options_.repeat->original)[identity];
    progress_.message(fmt::format("reference of {}: {}", scene.entry.name, image));
    return true;
}

void ExperimentRun::take_given_reference(SceneState& scene) {
    const std::string stored = folder_.reference_image(scene.entry.name);
    const GivenReference given =
        given_reference(scene.entry.reference_image, scene.width, scene.height, scene.content_hash);
    if (given.identity != stored_reference_identity(stored)) write_reference(stored, given.reference);
    scene.reference = given.identity;
    scene.notes = given.notes;
    progress_.message(fmt::format("reference of {}: {}", scene.entry.name, scene.entry.reference_image));
    for (const auto& note : scene.notes)
        progress_.message("warning: " + note);
}

}  // namespace gib
