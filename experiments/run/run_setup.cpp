#include "experiments/run/run_setup.h"

#include "common/core/reject.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "common/scene/scene.h"
#include "experiments/external/povray_scene.h"
#include "experiments/system/build_info.h"
#include "methods/method.h"
#include "methods/path/lit_spots.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

namespace gib {

namespace {

SceneLoadOptions loading_of(const Experiment& experiment) { return {{}, experiment.resolution, experiment.paths}; }

/// The scene in POV-Ray's form; empty if no selected method takes it. Throws InputError for what it cannot express.
std::string povray_form(const Experiment& experiment, const std::string& only, const ExperimentScene& entry,
                        const LoadedScene& loaded) {
    for (const MethodLabel& label : experiment.methods)
        if (const auto* external = experiment.external(label);
            external && is_kept(only, entry.name, label.text()) && external->scene_format == SceneFormat::povray)
            return povray_scene(loaded, entry.path, loading_of(experiment));
    return "";
}

void plan_methods(RunSetup& setup, const LoadedScene& scene, ProgressLine& progress) {
    for (const auto& label : setup.experiment.methods) {
        if (setup.experiment.external(label)) continue;
        const Plan plan = ConfiguredMethod(label).create({scene.max_edges})->plan(*scene.scene);
        setup.left_out[{scene.name, label.text()}] = {plan.missing, Components(plan.unresolved)};
        if (const auto incomplete = incomplete_components(plan, label); !incomplete.empty())
            progress.message(fmt::format("warning: {}: {}", scene.name, incomplete));
        if (const auto light = seldom_found_light(*scene.scene, label); !light.empty())
            progress.message(fmt::format("warning: {}: {}", scene.name, light));
    }
}

void require_a_cell(const RunSetup& setup, const std::string& only) {
    for (const RunScene& scene : setup.scenes)
        for (const MethodLabel& label : setup.experiment.methods)
            if (is_kept(only, scene.entry.name, label.text())) return;
    reject({}, "--only '{}' keeps no cell: it is in no scene's name and in no method's label", only);
}

/// The samples a pixel of a cell of another renderer; 1 if its command does not take them.
std::uint32_t passes_of(const ExternalMethod& external, const std::optional<int>& sample_count) {
    if (!external.takes("spp")) return 1;
    return external.spp ? *external.spp : static_cast<std::uint32_t>(sample_count.value_or(16));
}

}  // namespace

LoadedScene RunSetup::load(const RunScene& scene) const {
    LoadedScene loaded = load_scene(scene.entry.path, loading_of(experiment));
    if (loaded.content_hash != scene.content_hash)
        throw RunError(fmt::format("the scene '{}' was changed while the experiment ran", scene.entry.name));
    return loaded;
}

RunSetup checked_setup(Experiment experiment, const RunOptions& options) {
    ProgressLine progress;
    RunSetup setup{.experiment = std::move(experiment),
                   .threads = options.threads > 0 ? options.threads
                                                  : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
                   .program = options.program,
                   .command_line = options.command_line,
                   .build = executable_hash()};
    if (options.seeds) setup.experiment.seeds = *options.seeds;
    for (const auto& entry : setup.experiment.scenes) {
        const auto start = std::chrono::steady_clock::now();
        const LoadedScene loaded = load_scene(entry.path, loading_of(setup.experiment));
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        progress.message(fmt::format("{}: loaded in {:.3f} s (not charged)", entry.name, seconds.count()));
        for (const auto& warning : loaded.warnings)
            progress.message("warning: " + warning);
        plan_methods(setup, loaded, progress);
        setup.scenes.push_back({.entry = entry,
                                .content_hash = loaded.content_hash,
                                .sample_count = loaded.sample_count,
                                .width = loaded.scene->sensor().width(),
                                .height = loaded.scene->sensor().height(),
                                .povray = povray_form(setup.experiment, options.only, entry, loaded)});
    }
    require_a_cell(setup, options.only);
    return setup;
}

WorkCell work_cell(const RunSetup& setup, std::size_t scene, const MethodLabel& label, std::uint64_t seed) {
    const RunScene& of = setup.scenes[scene];
    const ExternalMethod* external = setup.experiment.external(label);
    CellIdentity identity;
    identity.scene = of.entry.name;
    identity.method = label.text();
    identity.seed = seed;
    identity.scene_hash = of.content_hash;
    identity.spp =
        external ? passes_of(*external, of.sample_count) : last_pass(ConfiguredMethod(label).values, of.sample_count);
    const ExternalMethod* filter = external ? nullptr : setup.experiment.filter_command(label);
    if (external || filter) identity.command = (external ? external : filter)->identity();
    identity.budget = setup.experiment.budget;
    identity.epsilon = setup.experiment.epsilon;
    identity.threads = setup.threads;
    return {.scene = scene,
            .external = external,
            .filter = filter,
            .identity = identity,
            .name = cell_folder_name(identity.scene, identity.method, seed)};
}

std::string WorkCell::text() const {
    return fmt::format("{}, {}, seed {}", identity.scene, identity.method, identity.seed);
}

WorkList::WorkList(const RunSetup& setup, const std::string& only) {
    for (int seed = 1; seed <= setup.experiment.seeds; ++seed)
        for (std::size_t scene = 0; scene < setup.scenes.size(); ++scene)
            for (const MethodLabel& label : setup.experiment.methods) {
                cells_.push_back(work_cell(setup, scene, label, static_cast<std::uint64_t>(seed)));
                cells_.back().is_selected = is_kept(only, cells_.back().identity.scene, label.text());
            }
}

void WorkList::keep(const std::map<std::string, Budget>& budgets) {
    std::erase_if(cells_, [&](const WorkCell& cell) { return budgets.count(cell.name) == 0; });
    for (WorkCell& cell : cells_)
        cell.identity.budget = budgets.at(cell.name);
}

void WorkList::select(const RunShare& share) {
    std::size_t place = 0;
    for (WorkCell& cell : cells_)
        cell.is_selected = cell.is_selected && share.has(place++);
}

void WorkList::use(const References& references) {
    for (WorkCell& cell : cells_)
        cell.identity.reference = references.has_failed(cell.scene) ? "" : references.identity(cell.scene);
}

bool WorkList::has(std::size_t scene) const {
    return std::ranges::any_of(cells_, [&](const WorkCell& cell) { return cell.is_selected && cell.scene == scene; });
}

std::vector<const WorkCell*> WorkList::selected() const {
    std::vector<const WorkCell*> cells;
    for (const WorkCell& cell : cells_)
        if (cell.is_selected) cells.push_back(&cell);
    return cells;
}

std::vector<CellState> WorkList::states(const ResultFolder& folder) const {
    std::vector<CellState> states;
    for (const WorkCell* cell : selected()) {
        CellState& state = states.emplace_back(CellState{.cell = cell, .record = {}, .damage = {}});
        if (!cell->identity.reference.empty())
            state.record = folder.read_cell(cell->name, cell->identity.key(), &state.damage);
    }
    return states;
}

std::vector<const WorkCell*> left_of(const std::vector<CellState>& states) {
    std::vector<const WorkCell*> left;
    for (const CellState& state : states)
        if (!state.record) left.push_back(state.cell);
    return left;
}

std::vector<ManifestCell> manifest_cells(const WorkList& list, const ResultFolder& folder) {
    std::vector<ManifestCell> complete;
    for (const WorkCell& cell : list.all())
        if (const auto stored = folder.read_cell(cell.name, cell.identity.key()))
            complete.push_back({.scene = stored->scene,
                                .method = stored->method,
                                .seed = stored->seed,
                                .passes = stored->last().passes,
                                .image = stored->image.empty() ? image_digest(read_image(folder.cell_image(cell.name)))
                                                               : stored->image});
    return complete;
}

}  // namespace gib
