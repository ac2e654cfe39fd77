#include "experiments/run/run_setup.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/scene/scene.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/system/build_info.h"
#include "experiments/system/interrupt.h"
#include "experiments/system/progress.h"
#include "methods/method.h"
#include "methods/path/lit_spots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <limits>
#include <thread>

namespace gib {

namespace {

SceneLoadOptions loading_of(const Experiment& experiment) { return {{}, experiment.resolution, experiment.paths}; }

/// The largest number of edges of a path of a label, whose method may be `auto`.
int max_edges_of(const MethodLabel& label, int scene_edges) {
    for (const auto& [name, value] : label.values)
        if (name == "max_depth")
            if (const auto depth = number_from<int>(value))
                return *depth == 0 ? std::numeric_limits<int>::max() : *depth;
    return scene_edges;
}

/// The components whose paths a method cuts by its `max_depth`, and the reference does not.
Components components_beyond(const MethodLabel& label, const MethodLabel& reference, int scene_edges) {
    const int edges = max_edges_of(label, scene_edges);
    Components beyond;
    if (edges >= max_edges_of(reference, scene_edges)) return beyond;
    for (const Component c : {Component::caustic, Component::indirect, Component::volume})
        beyond.add(c);
    if (edges < 2) beyond.add(Component::direct);
    return beyond;
}

void plan_methods(RunSetup& setup, const LoadedScene& scene, ProgressLine& progress) {
    for (const auto& label : setup.experiment.methods) {
        if (setup.experiment.external(label)) continue;
        const Plan plan = ConfiguredMethod(label).create({scene.max_edges})->plan(*scene.scene);
        LeftOut& left_out = setup.left_out[{scene.name, label.text()}] = {plan.missing, Components(plan.unresolved)};
        for (const Component c : components_beyond(label, setup.experiment.reference_method, scene.max_edges).list())
            left_out.components.add(c);
        if (const auto incomplete = incomplete_components(plan, label); !incomplete.empty())
            progress.message(fmt::format("warning: {}: {}", scene.name, incomplete));
        if (const auto light = seldom_found_light(*scene.scene, label); !light.empty())
            progress.message(fmt::format("warning: {}: {}", scene.name, light));
    }
}

void require_a_cell(const RunSetup& setup, const std::string& only) {
    for (const RunScene& scene : setup.scenes)
        for (const MethodLabel& label : setup.experiment.methods)
            if (is_kept(only, setup.experiment, scene.entry.name, label)) return;
    reject({}, "--only '{}' keeps no cell: it is in no scene's name and in no method's label or name", only);
}

}  // namespace

int RunLog::exit_code() const {
    if (failures.empty()) return 0;
    std::cerr << fmt::format("{} failed:\n", failures.size());
    for (const Failure& failure : failures)
        std::cerr << "  " << failure.text() << "\n";
    return exit_failed;
}

LoadedScene RunSetup::load(const RunScene& scene) const {
    LoadedScene loaded = load_scene(scene.entry.path, loading_of(experiment));
    if (loaded.content_hash != scene.content_hash)
        throw RunError(fmt::format("the scene '{}' was changed while the experiment ran", scene.entry.name));
    return loaded;
}

bool is_kept(const std::string& only, const Experiment& experiment, const std::string& scene,
             const MethodLabel& method) {
    std::string name;
    if (const auto given = experiment.given_names.find(method.text()); given != experiment.given_names.end()) {
        name = given->second;
        for (const auto& [key, value] : method.values)
            name += fmt::format(", {}={}", key, value);
    }
    return std::ranges::any_of(std::array{scene, method.text(), name},
                               [&](const std::string& text) { return text.find(only) != std::string::npos; });
}

RunSetup checked_setup(Experiment experiment, const RunOptions& options) {
    ProgressLine progress;
    progress.quiet = options.quiet;
    RunSetup setup{.experiment = std::move(experiment),
                   .threads = options.threads > 0 ? options.threads
                                                  : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
                   .command_line = options.command_line,
                   .build = executable_hash()};
    if (options.seeds) setup.experiment.seeds = *options.seeds;
    for (const auto& entry : setup.experiment.scenes) {
        const auto start = std::chrono::steady_clock::now();
        const LoadedScene loaded = load_scene(entry.path, loading_of(setup.experiment));
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        progress.note(fmt::format("{}: loaded in {:.3f} s (not charged)", entry.name, seconds.count()));
        for (const auto& warning : loaded.warnings)
            progress.message("warning: " + warning);
        plan_methods(setup, loaded, progress);
        setup.scenes.push_back({.entry = entry,
                                .content_hash = loaded.content_hash,
                                .attributes = scene_attributes(loaded),
                                .sample_count = loaded.sample_count,
                                .width = loaded.scene->sensor().width(),
                                .height = loaded.scene->sensor().height()});
    }
    require_a_cell(setup, options.only);
    return setup;
}

}  // namespace gib
