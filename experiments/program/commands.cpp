#include "experiments/program/commands.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/scene/scene.h"
#include "experiments/filter/checkpoint_filter.h"
#include "experiments/measuring/measure.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/photons/page.h"
#include "experiments/plan/label_checks.h"
#include "experiments/program/kept_references.h"
#include "experiments/references/reference.h"
#include "experiments/references/store.h"
#include "experiments/report/report.h"
#include "experiments/system/build_info.h"
#include "experiments/system/file_lock.h"
#include "experiments/system/interrupt.h"
#include "experiments/system/progress.h"
#include "experiments/system/shipped_files.h"
#include "methods/path/lit_spots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string_view>

namespace gib {

namespace {

void warn_of_non_finite(const NonFinite& bad, std::uint64_t seed) {
    if (bad.count == 0) return;
    std::cerr << fmt::format(
        "warning: {} samples were not finite and were dropped; first: seed {}, pass {}, pixel {}\n", bad.count, seed,
        bad.first_pass, bad.first_pixel);
}

std::vector<std::string> plan_lines(const ConfiguredMethod& method, const LoadedScene& loaded) {
    const Plan plan = method.create({loaded.max_edges})->plan(*loaded.scene);
    std::vector<std::string> lines;
    for (const auto& step : plan.steps)
        lines.push_back(step.runs ? fmt::format("runs: {}", step.name)
                                  : fmt::format("skipped: {} ({})", step.name, step.reason));
    if (const std::string filter = filter_of(method.label); !filter.empty())
        lines.push_back(fmt::format("runs: features\nruns: filter {} (biased; its time is charged)", filter));
    for (Effect e : plan.missing.list())
        lines.push_back(fmt::format("missing: {}", name_of(e)));
    for (Component c : plan.unresolved)
        lines.push_back(fmt::format("not sampled: {}", name_of(c)));
    if (auto light = seldom_found_light(*loaded.scene, method.label); !light.empty())
        lines.push_back("warning: " + light);
    return lines;
}

bool has_line(const std::vector<std::string>& lines, const std::string& line) {
    return std::ranges::find(lines, line) != lines.end();
}

/// The lines that all methods have, which are printed once.
std::vector<std::string> common_lines(const std::vector<std::vector<std::string>>& methods) {
    std::vector<std::string> common = methods.front();
    std::erase_if(common, [&](const std::string& line) {
        return !std::ranges::all_of(methods, [&](const auto& lines) { return has_line(lines, line); });
    });
    return common;
}

/// Warns of the effects of the scene that the method does not simulate, and of components that it samples incompletely
/// or rarely.
void warn_of_left_out(const Scene& scene, const Plan& plan, const MethodLabel& label, ProgressLine& progress) {
    std::vector<std::string_view> effects;
    for (Effect e : plan.missing.list())
        effects.push_back(name_of(e));
    if (!effects.empty())
        progress.message(fmt::format("warning: '{}' does not simulate all effects of the scene; it leaves out: {}",
                                     label.text(), fmt::join(effects, ", ")));
    if (const auto incomplete = incomplete_components(plan, label); !incomplete.empty())
        progress.message("warning: " + incomplete);
    if (const auto light = seldom_found_light(scene, label); !light.empty()) progress.message("warning: " + light);
}

void warn_of(const std::vector<std::string>& warnings) {
    for (const auto& what : warnings)
        std::cerr << fmt::format("warning: {}\n", what);
}

/// The warnings about a scene, also that it has no emitter.
std::vector<std::string> warnings_of(const LoadedScene& loaded) {
    std::vector<std::string> warnings = loaded.warnings;
    if (!loaded.scene->has_light()) warnings.push_back("nothing in the scene emits light: every image is black");
    return warnings;
}

/// Throws InputError if references were made but none can be read: the tables would have no rows and replace those
/// that have. A run that has made no reference yet is accepted, because it has no tables to lose.
void require_a_scene(const Analysis& analysis, const ResultFolder& folder) {
    const auto& scenes = analysis.index.scenes;
    const bool had_one = std::ranges::any_of(scenes, [](const IndexScene& scene) { return !scene.reference.empty(); });
    if (had_one && analysis.references.empty())
        throw InputError(
            fmt::format("no scene of '{}' has a reference that can be read: its tables and its report "
                        "stay as they are; the run's command makes references again",
                        folder.path()));
}

void print_what_is_shown(const CollectedLight& light, std::ostream& out) {
    for (const PhotonSubset::Map& map : light.photons)
        out << fmt::format("{} map: {} of {} photons shown ({:.3g} %)\n", map.name, map.shown.size(), map.stored,
                           100 * static_cast<double>(map.shown.size()) / static_cast<double>(map.stored));
    if (!light.beams.beams.empty())
        out << fmt::format("beams: {} of {} shown\n", light.beams.beams.size(), light.stored_beams);
    if (!light.records.empty()) out << fmt::format("irradiance records: {}\n", light.records.size());
    if (!light.patches.patches.empty())
        out << fmt::format("patches: {}, corners: {}\n", light.patches.patches.size(), light.patches.corners.size());
    if (light.passes > 0) out << fmt::format("passes: {}\n", light.passes);
}

void warn_of_what_is_not(const CollectedLight& light, const std::string& method, ProgressLine& progress) {
    if (light.empty())
        progress.message(fmt::format("warning: '{}' stores no light in this scene; skipped: {}", method,
                                     fmt::join(light.skipped, ", ")));
    for (const PhotonSubset::Map& map : light.photons)
        if (map.not_finite > 0)
            progress.message(
                fmt::format("warning: {} photons of the {} map have no finite power and are shown with "
                            "power 0",
                            map.not_finite, map.name));
}

/// The scene of a file or of a name, with its warnings printed.
LoadedScene loaded_with_warnings(const std::string& scene, const SceneLoadOptions& loading) {
    LoadedScene loaded = load_scene(scene_file(scene), loading);
    warn_of(warnings_of(loaded));
    return loaded;
}

/// Throws InputError unless `path` has this extension and can be created in a folder that exists.
void check_writable(const std::string& path, std::string_view extension = ".exr") {
    const std::filesystem::path file(path);
    const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
    if (file.extension() != extension)
        throw InputError(fmt::format("the output '{}' has to end in {}", path, extension));
    if (!std::filesystem::is_directory(folder))
        throw InputError(fmt::format("cannot write '{}': there is no folder '{}'", path, folder));
    if (std::filesystem::is_directory(file)) throw InputError(fmt::format("cannot write '{}': it is a folder", path));
    require_writable(folder);
    remove_leftovers_of(path);
}

}  // namespace

void render(const RenderOptions& options, std::ostream& out) {
    const ConfiguredMethod chosen(MethodLabel::parse(options.method));
    require_own_filter(chosen.label);
    check_writable(options.out);
    require_no_reference(options.out);
    const LoadedScene loaded = loaded_with_warnings(options.scene, options.loading);
    const auto method = chosen.create({loaded.max_edges});
    CheckpointFilter filter(*loaded.scene, options.seed,
                            {.non_local_means = !filter_of(chosen.label).empty(), .features = options.features});
    const MeasureWork work{.scene = *loaded.scene,
                           .method = *method,
                           .seed = options.seed,
                           .spp = last_pass(chosen.values, loaded.sample_count),
                           .budget = {},
                           .only_last = true,
                           .filter = filter.does_anything() ? &filter : nullptr};
    LayeredImage image;
    Measurement measured;
    ProgressLine progress;
    warn_of_left_out(*loaded.scene, method->plan(*loaded.scene), chosen.label, progress);
    const auto keep = [&](const Checkpoint& checkpoint, ComponentImages&& components) {
        image = layers_of(std::move(components));
        for (auto& layer : filter.layers(checkpoint.passes))
            image.layers.push_back(std::move(layer));
    };
    const auto show = [&](const OngoingWork& ongoing) {
        const double share = ongoing.preparing ? ongoing.fraction : (ongoing.passes + ongoing.fraction) / work.spp;
        const std::optional<double> left = share > 0 ? std::optional(ongoing.seconds * (1 / share - 1)) : std::nullopt;
        progress.update(share, left, fmt::format("{}, {}: {}", loaded.name, options.method, ongoing.stage));
    };
    with_threads(options.threads, [&] { measured = measure(work, keep, {}, show); });
    const Checkpoint& last = measured.checkpoints.back();
    image.metadata = {{"method", chosen.label.text()},
                      {"seed", std::to_string(options.seed)},
                      {"passes", std::to_string(last.passes)},
                      {"seconds", fmt::format("{:.6f}", last.seconds)},
                      {"program", program_version()}};
    image.metadata.merge(scene_attributes(loaded));
    for (const auto& [name, value] : measured.facts)
        image.metadata[name] = value;
    write_exr(options.out, image, Flush::later);
    progress.message(fmt::format("{}: {} passes", options.out, last.passes));
    out << fmt::format("seconds: {:.4f}\nrays: {}\nrays per second: {:.4g}\n", last.seconds, last.counts.rays,
                       static_cast<double>(last.counts.rays) / last.seconds);
    for (const auto& [name, value] : measured.facts)
        out << fmt::format("{}: {}\n", name, value);
    warn_of_non_finite(last.counts.non_finite, options.seed);
}

void make_reference_file(const ReferenceOptions& options, std::ostream& out) {
    const MethodLabel label = MethodLabel::parse(options.method);
    static_cast<void>(reference_methods(label));  // the label's errors come before the scene is loaded
    if (options.epsilon) require_epsilon(*options.epsilon);
    // isfinite() comes first: a comparison with NaN would be an invalid operation, which some builds trap.
    if (options.seconds && !(std::isfinite(*options.seconds) && *options.seconds > 0))
        throw InputError("--max-seconds needs a finite number above 0");
    check_writable(options.out);
    ReferenceGoal goal{std::nullopt, options.seconds};
    if (options.target) goal.target = parse_target(*options.target);
    if (!goal.target && !goal.seconds) goal.target = parse_target("1%");
    const LoadedScene loaded = loaded_with_warnings(options.scene, options.loading);
    const InterruptGuard guard;
    ProgressLine progress;
    if (const auto light = seldom_found_light(*loaded.scene, label); !light.empty())
        progress.message("warning: " + light);
    FinishedReference finished;
    const ReferenceWork work{.scene = loaded,
                             .methods = methods_for(loaded, label),
                             .label = label,
                             .goal = goal,
                             .epsilon = options.epsilon,
                             .path = options.out,
                             .seed = options.seed};
    const FileLock lock = lock_reference(options.out, [&](const std::string& owner) {
        progress.message(fmt::format("{}: {} is making it; waiting until it has ended", options.out, owner));
    });
    if (!options.replace) require_own_reference(options.out, reference_key(loaded.content_hash, label, options.seed));
    with_threads(options.threads, [&] { finished = make_reference(work, progress); });
    for (const auto& warning : finished.warnings)
        progress.message("warning: " + warning);
    out << fmt::format("relative standard error: {:.4g} % (epsilon {:.6g})\n", 100 * finished.relative_error,
                       finished.epsilon);
}

void print_plan(const std::string& scene, const std::string& method, const SceneLoadOptions& loading,
                std::ostream& out) {
    std::vector<ConfiguredMethod> chosen;
    if (method.empty())
        for (const auto& name : names_of_comparable_methods())
            chosen.emplace_back(MethodLabel{name, {}});
    else chosen.emplace_back(MethodLabel::parse(method));
    require_own_filter(chosen.front().label);
    const LoadedScene loaded = load_scene(scene_file(scene), loading);
    for (const auto& warning : warnings_of(loaded))
        out << "warning: " << warning << "\n";
    for (Effect e : effects_of(*loaded.scene).list())
        out << "called for: " << name_of(e) << "\n";
    std::vector<std::vector<std::string>> lines;
    for (const auto& one : chosen)
        lines.push_back(plan_lines(one, loaded));
    const auto common = method.empty() ? common_lines(lines) : std::vector<std::string>();
    if (!common.empty()) out << "\nevery method\n" << fmt::format("{}\n", fmt::join(common, "\n"));
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (method.empty()) out << "\nmethod: " << chosen[i].label.name << "\n";
        for (const std::string& line : lines[i])
            if (!has_line(common, line)) out << line << "\n";
    }
}

void rebuild_report(const std::string& folder_path, std::ostream& out) {
    // The index is read before the lock is taken, so that a folder without results gives that error.
    static_cast<void>(ResultFolder(folder_path).read_index());
    const FileLock lock = lock_result_folder(folder_path);  // a run at the same time would write the same files
    const ResultFolder folder(folder_path);
    std::string report;
    std::vector<std::string> damage;
    with_threads(0, [&] {
        const Analysis analysis = analyse(folder);
        warn_of(analysis.damage);
        require_a_scene(analysis, folder);
        write_tables(analysis, folder);
        report = write_report(analysis, folder, &damage);
    });
    warn_of(damage);
    out << "Report: " << report << "\n";
}

void show_photons(const PhotonsOptions& options, std::ostream& out) {
    const ConfiguredMethod method(MethodLabel::parse(options.method));
    require_stored_light(method.label);
    method.values.refuse({"filter"}, "photons: no image is made");
    check_writable(options.out, ".html");
    const LoadedScene scene = loaded_with_warnings(options.scene, options.loading);
    ProgressLine progress;
    const StoredLightWork work{
        .scene = scene,
        .method = method,
        .seed = options.seed,
        .most_passes = options.passes.value_or(std::min(last_pass(method.values, scene.sample_count), default_passes)),
        .most_photons = options.most_photons,
        .listener = [&](std::string_view stage, double fraction) {
            progress.update(fraction, std::nullopt, fmt::format("{}, {}: {}", scene.name, options.method, stage));
        }};
    with_threads(options.threads, [&] {
        const CollectedLight light = collect_stored_light(work);
        warn_of_what_is_not(light, options.method, progress);
        const ShownImage image = shown_image(
            {.scene = scene,
             .method = method,
             .seed = options.seed,
             .passes = light.passes > 0 ? light.passes
                                        : std::min(work.most_passes, options.passes.value_or(default_image_passes)),
             .observer = [&](const OngoingWork& ongoing) { work.listener(ongoing.stage, ongoing.fraction); }});
        write_file(options.out, photons_page({scene, method.label.text(), options.seed, light, &image}));
        print_what_is_shown(light, out);
    });
    progress.message(options.out);
}

}  // namespace gib
