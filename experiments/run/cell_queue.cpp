#include "experiments/run/cell_queue.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/core/reject.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "common/scene/scene.h"
#include "experiments/external/povray_scene.h"
#include "experiments/measuring/reference.h"
#include "experiments/report/report.h"
#include "experiments/report/tables.h"
#include "experiments/results/flip_record.h"
#include "experiments/results/frames.h"
#include "experiments/results/judgement.h"
#include "experiments/results/manifest.h"
#include "experiments/run/repeat_plan.h"
#include "experiments/system/build_info.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

namespace gib {

namespace {

namespace fs = std::filesystem;

Experiment with_options(Experiment experiment, const RunOptions& options) {
    if (options.seeds) experiment.seeds = *options.seeds;
    return experiment;
}

/// Estimates the seconds that a cell takes: those of the last one of its scene and method, else the mean of all.
class CostModel {
public:
    void add(const CellIdentity& cell, double seconds) {
        known_[{cell.scene, cell.method}] = seconds;
        sum_ += seconds;
        ++count_;
    }
    std::optional<double> of(const CellIdentity& cell) const {
        if (const auto found = known_.find({cell.scene, cell.method}); found != known_.end()) return found->second;
        return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt;
    }

private:
    std::map<std::pair<std::string, std::string>, double> known_;
    double sum_ = 0;
    int count_ = 0;
};

/// The samples a pixel of a cell of another renderer; 1 if its command does not take them.
std::uint32_t passes_of(const ExternalMethod& external, const std::optional<int>& sample_count) {
    if (!external.takes("spp")) return 1;
    return external.spp ? *external.spp : static_cast<std::uint32_t>(sample_count.value_or(16));
}

/// The share of a cell's work that is done, by the limit (spp, passes or seconds) that is nearest.
double share_done(const CellIdentity& cell, std::uint32_t passes, double seconds) {
    const auto done = static_cast<double>(passes);
    double share = done / cell.spp;
    if (cell.budget.passes) share = std::max(share, done / *cell.budget.passes);
    if (cell.budget.seconds) share = std::max(share, seconds / *cell.budget.seconds);
    return std::min(share, 1.0);
}

}  // namespace

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

namespace {

/// Links a picture to `to`, or removes `to` if the tables do not have its cell.
void link_or_remove(bool is_there, const std::string& from, const std::string& to) {
    if (is_there) link_file(from, to);
    else fs::remove(to);
}

}  // namespace

ExperimentRun::ExperimentRun(const RunOptions& options)
    : options_(options),
      experiment_(
          with_options(options.repeat ? options.repeat->experiment : load_experiment(options.experiment), options)),
      threads_(options.threads > 0 ? options.threads
                                   : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))),
      folder_(options.out ? *options.out : result_folder_of(experiment_.name)),
      build_(executable_hash()) {
    for (const auto& entry : experiment_.scenes) {
        const auto start = std::chrono::steady_clock::now();
        const LoadedScene loaded = load(entry);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        if (options.repeat) options.repeat->check_scene(entry, loaded.content_hash);
        progress_.message(fmt::format("{}: loaded in {:.3f} s (not charged)", entry.name, seconds.count()));
        for (const auto& warning : loaded.warnings)
            progress_.message("warning: " + warning);
        plan_methods(loaded);
        scenes_.push_back({.entry = entry,
                           .content_hash = loaded.content_hash,
                           .sample_count = loaded.sample_count,
                           .width = loaded.scene->sensor().width(),
                           .height = loaded.scene->sensor().height(),
                           .povray = povray_form(entry, loaded)});
    }
    require_a_cell();
    prepare_folder();
    take_stored_references();
}

void ExperimentRun::require_a_cell() const {
    const bool any =
        std::any_of(scenes_.begin(), scenes_.end(), [&](const SceneState& scene) { return selected(scene); });
    if (!any) reject({}, "--only '{}' keeps no cell: it is in no scene's name and in no method's label", options_.only);
}

void ExperimentRun::prepare_folder() {
    folder_.prepare();
    if (!options_.shared) lock_.emplace(lock_result_folder(folder_.path()));
    const std::string references = fs::path(cached_reference_path("")).parent_path().string();
    ResultFolder::make(references);
    require_writable(references);
    if (options_.shared) return;
    folder_.remove_leftovers();
    remove_leftovers_in(references);
}

void ExperimentRun::take_stored_references() {
    // Scenes that are not selected, or not reached before Ctrl-C, keep the reference of their stored cells.
    const auto notes = stored_notes(folder_);
    for (auto& scene : scenes_) {
        const std::string image = folder_.reference_image(scene.entry.name);
        scene.reference = stored_reference_identity(image);
        if (const auto found = notes.find(scene.reference); found != notes.end()) scene.notes = found->second;
        if (scene.reference.empty() && fs::exists(image))
            progress_.message(
                fmt::format("warning: {} is damaged; without a new reference, no cell of {} is in the "
                            "tables",
                            image, scene.entry.name));
    }
}

LoadedScene ExperimentRun::load(const ExperimentScene& entry) const {
    return load_scene(entry.path, {{}, experiment_.resolution, experiment_.paths});
}

std::string ExperimentRun::povray_form(const ExperimentScene& entry, const LoadedScene& loaded) const {
    for (const MethodLabel& label : experiment_.methods)
        if (const auto* external = experiment_.external(label);
            external && selected(entry.name, label) && external->scene_format == SceneFormat::povray)
            return povray_scene(loaded, scene_places(entry.path, {{}, experiment_.resolution, experiment_.paths}));
    return "";
}

void ExperimentRun::plan_methods(const LoadedScene& scene) {
    for (const auto& warning : scene.warnings)
        progress_.message("warning: " + warning);
    for (const auto& label : experiment_.methods) {
        if (experiment_.external(label)) continue;
        const Plan plan = ConfiguredMethod(label).create({scene.max_edges})->plan(*scene.scene);
        effects_missing_[{scene.name, label.text()}] = plan.missing.names();
        components_missing_[{scene.name, label.text()}] = names_of(plan.unresolved);
        if (const auto incomplete = incomplete_components(plan, label); !incomplete.empty())
            progress_.message(fmt::format("warning: {}: {}", scene.name, incomplete));
    }
}

bool ExperimentRun::selected(const std::string& scene, const MethodLabel& label) const {
    if (options_.repeat) return options_.repeat->has_cells_of(scene, label.text());
    return scene.find(options_.only) != std::string::npos || label.text().find(options_.only) != std::string::npos;
}

bool ExperimentRun::selected(const SceneState& scene) const {
    return std::any_of(experiment_.methods.begin(), experiment_.methods.end(),
                       [&](const MethodLabel& label) { return selected(scene.entry.name, label); });
}

bool ExperimentRun::measure() {
    if (options_.fresh) forget_cells();
    try {
        make_references();
        const std::vector<PlannedCell> all = cells();
        const auto to_do = cells_to_do(all);
        folder_.write_index(index());
        run_cells(to_do);
    } catch (const Interrupted&) {
        return false;
    }
    return true;
}

void ExperimentRun::forget_cells() {
    std::size_t forgotten = 0;
    for (const auto& cell : cells())
        if (selected(cell.scene->entry.name, *cell.label))
            forgotten += fs::remove(folder_.cell_folder(cell.name) + "/cell.json");
    if (forgotten > 0) progress_.message(fmt::format("cells forgotten that were measured before: {}", forgotten));
}

std::optional<ExperimentRun::PlannedCell> ExperimentRun::cell_at(const CellPlace& place) {
    SceneState& scene = scenes_.at(place.scene);
    const MethodLabel& label = experiment_.methods.at(place.method);
    CellIdentity identity;
    identity.scene = scene.entry.name;
    identity.method = label.text();
    identity.seed = place.seed;
    identity.scene_hash = scene.content_hash;
    const ExternalMethod* external = experiment_.external(label);
    identity.spp = external ? passes_of(*external, scene.sample_count)
                            : last_pass(ConfiguredMethod(label).values, scene.sample_count);
    if (external) identity.command = external->identity();
    identity.budget = experiment_.budget;
    identity.epsilon = experiment_.epsilon;
    identity.threads = threads_;
    identity.reference = scene.reference;
    const std::string name = cell_folder_name(identity.scene, identity.method, identity.seed);
    if (options_.repeat) {
        const auto passes = options_.repeat->passes.find(name);
        if (passes == options_.repeat->passes.end()) return std::nullopt;
        identity.budget = {std::nullopt, passes->second};
    }
    return PlannedCell{
        .scene = &scene, .label = &label, .external = external, .place = place, .identity = identity, .name = name};
}

std::vector<ExperimentRun::PlannedCell> ExperimentRun::cells() {
    std::vector<PlannedCell> cells;
    for (int seed = 1; seed <= experiment_.seeds; ++seed)
        for (std::size_t scene = 0; scene < scenes_.size(); ++scene)
            for (std::size_t method = 0; method < experiment_.methods.size(); ++method)
                if (auto cell = cell_at({scene, method, static_cast<std::uint64_t>(seed)}))
                    cells.push_back(*std::move(cell));
    return cells;
}

std::vector<const ExperimentRun::PlannedCell*> ExperimentRun::cells_to_do(const std::vector<PlannedCell>& all) {
    std::vector<const PlannedCell*> to_do;
    std::size_t kept = 0, of_other_builds = 0, replaced = 0;
    for (const auto& cell : all) {
        if (cell.scene->failed || !selected(cell.scene->entry.name, *cell.label)) continue;
        std::string damage;
        const auto stored = folder_.read_cell(cell.name, cell.identity.key(), &damage);
        if (!stored) {
            if (!damage.empty()) progress_.message(fmt::format("warning: {}; the cell is done again", damage));
            else if (fs::exists(folder_.cell_folder(cell.name) + "/cell.json")) ++replaced;
            to_do.push_back(&cell);
            continue;
        }
        ++kept;
        if (stored->build != build_) ++of_other_builds;
    }
    if (kept > 0) progress_.message(fmt::format("cells complete already, not done again: {}", kept));
    if (replaced > 0)
        progress_.message(
            fmt::format("cells measured before with another scene file, reference, budget, epsilon, "
                        "command or number of threads, done again: {}",
                        replaced));
    if (of_other_builds > 0)
        progress_.message(fmt::format(
            "warning: {} of them were measured by another build of gibench; --fresh does them again", of_other_builds));
    return to_do;
}

void ExperimentRun::run_cells(const std::vector<const PlannedCell*>& to_do) {
    // Only one reference is in memory, because those of many scenes would not fit. Within a seed, the cells of a
    // scene follow each other.
    const SceneState* referred = nullptr;
    std::optional<Reference> reference;
    CostModel costs;
    for (std::size_t i = 0; i < to_do.size(); ++i) {
        if (options_.may_start && !options_.may_start()) {
            progress_.message(fmt::format("no time is left for {} cells", to_do.size() - i));
            break;
        }
        const PlannedCell& cell = *to_do[i];
        double left_after = 0;
        bool known = true;
        for (std::size_t j = i + 1; j < to_do.size(); ++j) {
            const auto cost = costs.of(to_do[j]->identity);
            known = known && cost;
            left_after += cost.value_or(0);
        }
        const auto what = fmt::format("cell {} of {}: {}, {}, seed {}", i + 1, to_do.size(), cell.identity.scene,
                                      cell.identity.method, cell.identity.seed);
        const auto start = std::chrono::steady_clock::now();
        const auto show = [&](std::uint32_t passes, double seconds) {
            const double share = share_done(cell.identity, passes, seconds);
            const double left = passes > 0 ? seconds * (1 / share - 1) : costs.of(cell.identity).value_or(0);
            progress_.update(
                (static_cast<double>(i) + share) / static_cast<double>(to_do.size()),
                known && (passes > 0 || costs.of(cell.identity)) ? std::optional(left + left_after) : std::nullopt,
                what);
        };
        show(0, 0);
        try_cell(cell, reference, referred, show);
        costs.add(cell.identity, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
}

void ExperimentRun::try_cell(const PlannedCell& cell, std::optional<Reference>& reference, const SceneState*& referred,
                             const PassObserver& observer) {
    if (options_.shared) ResultFolder::make(folder_.cell_folder(cell.name));
    const auto lock = options_.shared ? FileLock::if_free(folder_.cell_folder(cell.name) + "/.lock") : std::nullopt;
    if (options_.shared && (!lock || folder_.read_cell(cell.name, cell.identity.key())))
        return;  // another process measures it, or has
    try {
        if (cell.identity.reference.empty()) throw RunError("the scene has no reference");
        if (referred != cell.scene) {
            referred = nullptr;
            reference.reset();
            reference = read_reference(folder_.reference_image(cell.identity.scene));
            referred = cell.scene;
        }
        run_cell(cell, Judgement(*reference), observer);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        fail(fmt::format("{}, {}, seed {}: {}", cell.identity.scene, cell.identity.method, cell.identity.seed,
                         error.what()));
        keep_failure(cell.name, error.what());
    }
}

void ExperimentRun::fail(const std::string& what) {
    failures_.push_back(what);
    progress_.message("failed: " + what);
}

ResultIndex ExperimentRun::index() {
    ResultIndex index;
    index.title = experiment_.title;
    index.experiment_text = experiment_.text;
    index.epsilon = experiment_.epsilon;
    index.seeds = experiment_.seeds;
    index.threads = threads_;
    for (const auto& scene : scenes_)
        index.scenes.push_back({.name = scene.entry.name,
                                .path = scene.entry.path,
                                .content_hash = scene.content_hash,
                                .reference = scene.reference,
                                .reference_method = scene.entry.reference_image.empty()
                                                        ? experiment_.reference_method.text()
                                                        : "the image " + scene.entry.reference_image,
                                .target = scene.entry.goal.target,
                                .notes = scene.notes});
    for (const auto& label : experiment_.methods)
        index.methods.push_back(label.text());
    for (const auto& [label, external] : experiment_.externals)
        index.externals.push_back(label);
    index.effects_missing = effects_missing_;
    index.components_missing = components_missing_;
    for (const auto& cell : cells())
        if (!cell.scene->reference.empty()) index.cell_keys[cell.name] = cell.identity.key();
    return index;
}

void ExperimentRun::link_images(const ResultIndex& index) {
    for (const auto& scene : index.scenes)
        for (const auto& method : index.methods) {
            const std::string name = cell_folder_name(scene.name, method, 1);
            const auto key = index.cell_keys.find(name);
            const bool complete = key != index.cell_keys.end() && folder_.read_cell(name, key->second);
            link_or_remove(complete, folder_.cell_image(name), folder_.method_image(scene.name, method));
            // A cell without FLIP has no map.
            link_or_remove(complete && fs::exists(folder_.flip_map(name)), folder_.flip_map(name),
                           folder_.method_flip_map(scene.name, method));
        }
}

std::vector<ManifestCell> ExperimentRun::complete_cells() {
    std::vector<ManifestCell> complete;
    for (const auto& cell : cells())
        if (const auto stored = folder_.read_cell(cell.name, cell.identity.key()))
            complete.push_back({.scene = stored->scene,
                                .method = stored->method,
                                .seed = stored->seed,
                                .passes = stored->last().passes,
                                .image = stored->image.empty() ? image_digest(read_image(folder_.cell_image(cell.name)))
                                                               : stored->image});
    return complete;
}

std::string ExperimentRun::write_results() {
    const ResultIndex now = index();
    folder_.write_index(now);
    write_file(folder_.file("manifest.json"), manifest_text(now, {.command_line = options_.command_line,
                                                                  .experiment_file = experiment_.path,
                                                                  .resolution = experiment_.resolution,
                                                                  .cells = complete_cells()}));
    std::string report;
    std::vector<std::string> damage;
    with_threads(threads_, [&] {
        const Analysis analysis = analyse(folder_);
        damage = analysis.damage;
        link_images(now);
        write_tables(analysis, folder_);
        report = write_report(analysis, folder_, &damage);
    });
    for (const auto& what : damage)
        progress_.message("warning: " + what);
    return report;
}

}  // namespace gib
