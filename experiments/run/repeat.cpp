#include "experiments/run/repeat.h"

#include "common/images/image_file.h"
#include "experiments/results/manifest.h"
#include "experiments/run/run_experiment.h"
#include "experiments/run/run_session.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <tuple>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// The path of a folder with its name at the end and no slash after it. "." and ".." are resolved, because "-repeat"
/// cannot be appended to them.
std::string named_folder(const std::string& folder) {
    fs::path path = fs::path(folder).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    if (path == "." || path.filename() == "..") path = fs::weakly_canonical(path);
    return path.string();
}

/// The path of the experiment file. It is relative to the current folder if all scenes are found from there, else to
/// the folder in which the run was started.
std::string experiment_path(const Manifest& manifest) {
    const bool here =
        std::ranges::all_of(manifest.scenes, [](const Manifest::Scene& scene) { return fs::exists(scene.file); });
    return here ? manifest.experiment_file : (fs::path(manifest.working_folder) / manifest.experiment_file).string();
}

/// The experiment of a run, as the run has read it.
Experiment experiment_of(const Manifest& manifest) {
    Experiment experiment = parse_experiment(manifest.experiment_text, experiment_path(manifest));
    experiment.seeds = manifest.seeds;
    experiment.epsilon = manifest.epsilon;
    return experiment;
}

/// Throws InputError, with the scene's file, if a scene with complete cells has changed since the run.
void require_same_scenes(const Manifest& manifest, const RunSetup& setup) {
    for (const RunScene& scene : setup.scenes)
        for (const auto& then : manifest.scenes)
            if (then.name == scene.entry.name && then.content_hash != scene.content_hash &&
                std::ranges::any_of(manifest.cells, [&](const Cell& cell) { return cell.scene == then.name; }))
                throw InputError(
                    {scene.entry.path},
                    "the scene was changed since the run (the file itself, or one that it uses): its images cannot "
                    "be repeated");
}

/// Takes the references of the run, and makes damaged ones again.
void take_references(const Manifest& manifest, const ResultFolder& original, RunSession& run) {
    for (std::size_t i = 0; i < run.setup.scenes.size(); ++i) {
        if (!run.list.has(i)) continue;
        const auto then = std::ranges::find_if(manifest.scenes, [&](const Manifest::Scene& scene) {
            return scene.name == run.setup.scenes[i].entry.name;
        });
        if (then == manifest.scenes.end() || !run.references.take(i, original, then->reference)) run.references.make(i);
    }
    run.list.use(run.references);
}

/// Renders all cells again. Returns false if the user interrupted it.
bool render_again(const Manifest& manifest, const ResultFolder& original, RunSession& run) {
    try {
        take_references(manifest, original, run);
        auto cells = run.list.selected();
        std::erase_if(cells, [&](const WorkCell* cell) { return run.references.has_failed(cell->scene); });
        run.write_index();
        run_cells(cells, run.runner, run.log.progress);
    } catch (const Interrupted&) {
        return false;
    }
    return true;
}

void warn_of_differences(const std::map<std::string, std::string>& then) {
    const auto now = this_machine();
    const auto of = [](const std::map<std::string, std::string>& machine, const std::string& what) {
        const auto found = machine.find(what);
        return found == machine.end() ? std::string("none") : found->second;
    };
    auto all = then;
    all.insert(now.begin(), now.end());
    for (const auto& [what, version] : all)
        if (of(then, what) != of(now, what))
            std::cerr << fmt::format("warning: the {} was '{}' and is '{}'; images may differ\n", what, of(then, what),
                                     of(now, what));
}

/// A text that says how far two images are apart; empty if they cannot be compared.
std::string difference(const std::string& path, const std::string& other_path) {
    try {
        const LayeredImage a = read_image(path), b = read_image(other_path);
        std::size_t values = 0, different = 0;
        double largest = 0;
        for (const auto& [name, layer] : a.layers) {
            const Image* other = b.find(name);
            if (!other || !other->same_size(layer)) return ": they have different layers or sizes";
            values += layer.rgb.size();
            for (std::size_t i = 0; i < layer.rgb.size(); ++i) {
                if (std::bit_cast<std::uint32_t>(layer.rgb[i]) == std::bit_cast<std::uint32_t>(other->rgb[i])) continue;
                ++different;
                largest = std::max(largest, std::abs(double{layer.rgb[i]} - other->rgb[i]));
            }
        }
        return fmt::format(": {} of {} values, by {:.3g} at most", different, values, largest);
    } catch (const InputError&) {
        return "";
    }
}

/// Warns of scenes whose numbers mean something else than in the run that is repeated.
void warn_of_unlike_numbers(const Manifest& then, const Manifest& now) {
    for (const Manifest::Scene& scene : now.scenes)
        for (const Manifest::Scene& old : then.scenes) {
            if (old.name != scene.name) continue;
            const Differences found = differences(old.quantities, scene.quantities);
            for (const std::string& what : {found.all, found.seconds, found.noted})
                if (!what.empty())
                    std::cerr << fmt::format("warning: {}: {}: numbers do not compare\n", scene.name, what);
        }
}

/// The message of what failed of a cell or of its scene's reference; empty if nothing did.
std::optional<std::string> failure_of(const Cell& cell, const RunLog& log) {
    const std::string name = fmt::format("{}, {}, seed {}", cell.scene, cell.method, cell.seed);
    for (const RunLog::Failure& failure : log.failures)
        if (failure.of == name || failure.of == reference_name(cell.scene)) return failure.message;
    return std::nullopt;
}

/// Prints a line for each cell. Returns whether all are identical.
bool compare_cells(const std::vector<Cell>& then, const ResultFolder& original, const RunSession& run,
                   std::ostream& out) {
    const auto now = complete_cells(run.list, run.folder);
    std::size_t identical = 0;
    for (const auto& cell : then) {
        const auto name =
            fmt::format("{}, {}, seed {}, {} passes", cell.scene, cell.method, cell.seed, cell.last().passes);
        const auto again = std::ranges::find_if(now, [&](const Cell& other) {
            return std::tie(other.scene, other.method, other.seed) == std::tie(cell.scene, cell.method, cell.seed);
        });
        if (again == now.end()) {
            const auto failure = failure_of(cell, run.log);
            out << fmt::format("not repeated  {}: {}\n", name,
                               failure.value_or("the experiment in the manifest does not have it"));
        } else if (again->last().passes == cell.last().passes && again->image == cell.image) {
            out << fmt::format("identical     {}\n", name);
            ++identical;
        } else {
            const auto folder = cell_folder_name(cell.scene, cell.method, cell.seed);
            const std::string how = again->last().passes != cell.last().passes
                                        ? fmt::format(": it ended after {}", again->last().passes)
                                        : difference(original.cell_image(folder), run.folder.cell_image(folder));
            out << fmt::format("differs       {}{}\n", name, how);
        }
    }
    out << fmt::format("{} of {} identical\n", identical, then.size());
    return identical == then.size();
}

}  // namespace

int repeat_run(const std::string& results, RunOptions options, std::ostream& out) {
    const InterruptGuard guard;
    const std::string folder = named_folder(results);
    const ResultFolder original(folder);
    original.require_known_format();
    const Manifest manifest = read_manifest(original.file("manifest.json"));
    if (manifest.cells.empty()) throw InputError({folder + "/manifest.json"}, "no cell is complete");
    if (!options.out) options.out = folder + "-repeat";
    if (std::error_code ignored; fs::equivalent(*options.out, folder, ignored))
        throw InputError("--repeat needs a folder of its own: --out is the one that is repeated");
    check_out(options);
    options.threads = manifest.threads;
    warn_of_differences(manifest.machine);

    RunSetup setup = checked_setup(experiment_of(manifest), options);
    require_same_scenes(manifest, setup);
    RunSession run(std::move(setup), options, FolderUse::alone);
    std::map<std::string, Budget> budgets;
    for (const auto& cell : manifest.cells)
        budgets[cell_folder_name(cell.scene, cell.method, cell.seed)] = {std::nullopt, cell.last().passes};
    run.list.keep(budgets);
    run.forget_cells();  // those of an earlier repetition would prove nothing
    const bool complete = render_again(manifest, original, run);
    const std::string report = run.write_results();
    if (!complete) {
        std::cerr << "interrupted: no image was compared\n";
        return exit_interrupted;
    }
    warn_of_unlike_numbers(manifest, read_manifest(run.folder.file("manifest.json")));
    const bool identical = compare_cells(manifest.cells, original, run, out);
    out << "Report: " << report << "\n";
    return identical ? 0 : exit_failed;
}

}  // namespace gib
