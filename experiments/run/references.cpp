#include "experiments/run/references.h"

#include "common/core/parallel.h"
#include "experiments/plan/label_checks.h"
#include "experiments/references/store.h"
#include "experiments/system/file_lock.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <filesystem>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// The notes in a folder's index, by the references' identities; empty if no index can be read.
std::map<std::string, std::vector<std::string>> stored_notes(const ResultFolder& folder) {
    std::map<std::string, std::vector<std::string>> notes;
    try {
        for (const auto& scene : folder.read_index().scenes)
            if (!scene.reference.empty()) notes[scene.reference] = scene.notes;
    } catch (const InputError&) {
        notes.clear();
    }
    return notes;
}

}  // namespace

References::References(const RunSetup& setup, const ResultFolder& folder, RunLog& log)
    : setup_(setup), folder_(folder), log_(log), entries_(setup.scenes.size()) {
    for (std::size_t scene = 0; scene < entries_.size(); ++scene) {
        read_stored(scene);
        const std::string& name = setup.scenes[scene].entry.name;
        const std::string image = folder.reference_image(name);
        if (entries_[scene].identity.empty() && fs::exists(image))
            log.progress.message(fmt::format(
                "warning: {} is damaged; without a new reference, no cell of {} is in the tables", image, name));
    }
}

void References::read_stored(std::size_t scene) {
    const std::string identity = stored_reference_identity(folder_.reference_image(setup_.scenes[scene].entry.name));
    entries_[scene] = {.identity = identity, .notes = stored_notes(folder_)[identity]};
}

std::vector<ReferenceBatch> References::advance(std::size_t scene, std::optional<double> most_own_work) {
    try {
        if (setup_.scenes[scene].entry.reference_image.empty()) return make(scene, most_own_work);
        take_given(scene);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        entries_[scene].has_failed = true;
        log_.fail(reference_name(setup_.scenes[scene].entry.name), error.what());
    }
    return {};
}

ReferenceWork References::work_of(const RunScene& scene, const LoadedScene& loaded,
                                  std::optional<double> most_own_work) const {
    const MethodLabel& label = setup_.experiment.reference_method;
    return {.scene = loaded,
            .methods = methods_for(loaded, label),
            .label = label,
            .goal = scene.entry.goal,
            .epsilon = setup_.experiment.epsilon,
            .path = cached_reference_path(reference_key(scene.content_hash, label)),
            .most_own_work = most_own_work};
}

std::vector<ReferenceBatch> References::make(std::size_t scene, std::optional<double> most_own_work) {
    const RunScene& of = setup_.scenes[scene];
    const LoadedScene loaded = setup_.load(of);
    const ReferenceWork work = work_of(of, loaded, most_own_work);
    // The lock is held until the folder has its own name for the file, because another run may replace the file at
    // any time after.
    const FileLock lock = lock_reference(work.path, [&](const std::string& owner) {
        log_.progress.note(
            fmt::format("{}: {} is making it; waiting until it has ended", reference_name(of.entry.name), owner));
    });
    FinishedReference finished;
    with_threads(setup_.threads, [&] { finished = make_reference(work, log_.progress); });
    if (!finished.missing.empty()) return finished.missing;
    link_file(work.path, folder_.reference_image(of.entry.name));
    entries_[scene] = {.identity = finished.identity, .notes = finished.warnings};
    log_.progress.note(fmt::format("reference of {}: relative standard error {:.3g} % (epsilon {:.4g}){}",
                                   of.entry.name, 100 * finished.relative_error, finished.epsilon,
                                   finished.rounds_added == 0 ? " (stored)" : ""));
    for (const auto& warning : finished.warnings)
        log_.progress.message("warning: " + warning);
    return {};
}

void References::make_batches(std::size_t scene, const std::vector<ReferenceBatch>& batches) const {
    const RunScene& of = setup_.scenes.at(scene);
    const LoadedScene loaded = setup_.load(of);
    const ReferenceWork work = work_of(of, loaded);
    for (std::size_t i = 0; i < batches.size(); ++i) {
        log_.progress.update(static_cast<double>(i) / static_cast<double>(batches.size()), std::nullopt,
                             fmt::format("reference of {}: batch {} of {}", of.entry.name, i + 1, batches.size()));
        with_threads(setup_.threads, [&] { make_batch(work, batches[i]); });
    }
}

bool References::take(std::size_t scene, const ResultFolder& from, const std::string& identity) {
    const std::string& name = setup_.scenes[scene].entry.name;
    const std::string image = from.reference_image(name);
    if (identity.empty() || stored_reference_identity(image) != identity) return false;
    link_file(image, folder_.reference_image(name));
    entries_[scene] = {.identity = identity, .notes = stored_notes(from)[identity]};
    log_.progress.note(fmt::format("reference of {}: {}", name, image));
    return true;
}

void References::take_given(std::size_t scene) {
    const RunScene& of = setup_.scenes[scene];
    const std::string stored = folder_.reference_image(of.entry.name);
    std::vector<std::string> images = of.entry.reference_replicates;
    images.insert(images.begin(), of.entry.reference_image);
    const GivenReference given = given_reference(images, of.width, of.height, of.attributes);
    if (given.identity != stored_reference_identity(stored)) write_reference(stored, given.reference);
    entries_[scene] = {.identity = given.identity, .notes = given.notes};
    log_.progress.note(fmt::format("reference of {}: {}", of.entry.name, of.entry.reference_image));
    for (const auto& note : given.notes)
        log_.progress.message("warning: " + note);
}

void link_file(const std::string& from, const std::string& to) {
    const std::string fresh = to + ".tmp-linked";  // remove_leftovers_in() finds it by this ending
    std::error_code error;
    fs::remove(fresh, error);
    fs::create_hard_link(from, fresh, error);
    if (error) fs::copy_file(from, fresh, fs::copy_options::overwrite_existing, error);
    if (!error) fs::rename(fresh, to, error);
    std::error_code ignored;
    fs::remove(fresh, ignored);  // after an error; rename() also leaves it if both were names of one file already
    if (error) throw RunError(fmt::format("cannot write '{}': {}", to, error.message()));
}

}  // namespace gib
