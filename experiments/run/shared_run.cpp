// A run of several processes: what each of them does, and what it leaves to the others.
#include "common/core/files.h"
#include "common/core/parallel.h"
#include "experiments/measuring/reference.h"
#include "experiments/run/cell_queue.h"
#include "experiments/system/build_info.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace gib {

namespace {

namespace fs = std::filesystem;

Experiment experiment_of(const RunPlan& plan) {
    Experiment experiment = parse_experiment(plan.experiment_text, plan.experiment);
    experiment.seeds = plan.seeds;
    return experiment;
}

RunOptions options_of(RunOptions options, const RunPlan& plan) {
    options.experiment = plan.experiment;
    options.out = plan.out;
    options.threads = plan.threads;
    options.seeds = plan.seeds;
    options.only = plan.only;
    options.command_line = plan.command_line;
    return options;
}

}  // namespace

ExperimentRun::ExperimentRun(const RunOptions& options, const RunPlan& plan)
    : options_(options_of(options, plan)),
      experiment_(experiment_of(plan)),
      threads_(plan.threads),
      folder_(plan.out),
      build_(executable_hash()) {
    if (plan.scenes.size() != experiment_.scenes.size())
        throw InputError({plan.experiment}, "the plan has another number of scenes");
    for (std::size_t i = 0; i < plan.scenes.size(); ++i)
        scenes_.push_back({.entry = experiment_.scenes[i],
                           .content_hash = plan.scenes[i].content_hash,
                           .sample_count = plan.scenes[i].sample_count,
                           .width = plan.scenes[i].width,
                           .height = plan.scenes[i].height});
    for (const auto& left_out : plan.left_out) {
        effects_missing_[{left_out.scene, left_out.method}] = left_out.effects;
        components_missing_[{left_out.scene, left_out.method}] = left_out.components;
    }
    prepare_folder();
}

RunPlan ExperimentRun::plan() const {
    RunPlan plan{.experiment = experiment_.path,
                 .experiment_text = experiment_.text,
                 .out = folder_.path(),
                 .only = options_.only,
                 .command_line = options_.command_line,
                 .threads = threads_,
                 .seeds = experiment_.seeds};
    for (const SceneState& scene : scenes_)
        plan.scenes.push_back({scene.entry.name, scene.content_hash, scene.sample_count, scene.width, scene.height});
    for (const MethodLabel& label : experiment_.methods)
        plan.methods.push_back(label.text());
    for (const auto& [cell, effects] : effects_missing_)
        plan.left_out.push_back({cell.first, cell.second, effects, components_missing_.at(cell)});
    return plan;
}

std::vector<CellState> ExperimentRun::states() {
    take_stored_references();
    std::vector<CellState> states;
    for (const PlannedCell& cell : cells()) {
        if (!selected(cell.identity.scene, *cell.label)) continue;
        CellState state{
            .place = cell.place, .scene = cell.identity.scene, .method = cell.identity.method, .name = cell.name};
        state.complete = cell.scene->missing.empty() && !cell.identity.reference.empty() &&
                         folder_.read_cell(cell.name, cell.identity.key());
        if (const std::string file = folder_.failure_file(cell.name); !state.complete && fs::exists(file))
            state.failure = read_file(file);
        states.push_back(state);
    }
    return states;
}

bool ExperimentRun::measure_cells(const std::vector<CellPlace>& places) {
    std::vector<PlannedCell> planned;
    for (const CellPlace& place : places) {
        SceneState& scene = scenes_.at(place.scene);
        if (scene.reference.empty())
            scene.reference = stored_reference_identity(folder_.reference_image(scene.entry.name));
        if (auto cell = cell_at(place)) planned.push_back(*std::move(cell));
    }
    // Only one reference is in memory.
    std::stable_sort(planned.begin(), planned.end(),
                     [](const PlannedCell& a, const PlannedCell& b) { return a.place.scene < b.place.scene; });
    try {
        std::vector<const PlannedCell*> to_do;
        for (const PlannedCell& cell : planned) {
            SceneState& scene = *cell.scene;
            const bool in_povray_form = cell.external && cell.external->scene_format == SceneFormat::povray;
            if (in_povray_form && scene.povray.empty()) scene.povray = povray_form(scene.entry, load(scene.entry));
            to_do.push_back(&cell);
        }
        run_cells(to_do);
    } catch (const Interrupted&) {
        return false;
    }
    return true;
}

std::vector<PlannedBatch> ExperimentRun::advance_references(double most_own_work) {
    most_own_work_ = most_own_work;
    take_stored_references();
    make_references();
    std::vector<PlannedBatch> missing;
    for (std::size_t i = 0; i < scenes_.size(); ++i)
        for (const ReferenceBatch& batch : scenes_[i].missing)
            missing.push_back({i, batch});
    return missing;
}

bool ExperimentRun::make_batches(const std::vector<PlannedBatch>& batches) {
    try {
        for (std::size_t i = 0; i < batches.size();) {
            const SceneState& scene = scenes_.at(batches[i].scene);
            const LoadedScene loaded = load(scene.entry);
            if (loaded.content_hash != scene.content_hash)
                throw RunError(fmt::format("the scene '{}' was changed after the run began", scene.entry.name));
            const ReferenceWork work = reference_work(scene, loaded);
            for (const std::size_t of = batches[i].scene; i < batches.size() && batches[i].scene == of; ++i) {
                progress_.update(
                    static_cast<double>(i) / static_cast<double>(batches.size()), std::nullopt,
                    fmt::format("reference of {}: batch {} of {}", scene.entry.name, i + 1, batches.size()));
                with_threads(threads_, [&] { make_batch(work, batches[i].batch); });
            }
        }
    } catch (const Interrupted&) {
        return false;
    }
    return true;
}

void ExperimentRun::keep_failure(const std::string& cell, const std::string& what) {
    try {
        ResultFolder::make(folder_.cell_folder(cell));
        write_file(folder_.failure_file(cell), what + "\n");
    } catch (const std::exception& error) {
        progress_.message(fmt::format("warning: the message is not kept: {}", error.what()));
    }
}

}  // namespace gib
