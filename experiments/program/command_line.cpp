#include "experiments/program/command_line.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "experiments/external/commands.h"
#include "experiments/measuring/cell_process.h"
#include "experiments/plan/label_checks.h"
#include "experiments/program/command_line_text.h"
#include "experiments/program/commands.h"
#include "experiments/program/compare.h"
#include "experiments/program/run_comparison.h"
#include "experiments/results/result_folder.h"
#include "experiments/run/repeat.h"
#include "experiments/run/run_experiment.h"
#include "experiments/slurm/status.h"
#include "experiments/slurm/submit.h"
#include "experiments/system/build_info.h"
#include "experiments/system/interrupt.h"
#include "experiments/system/shipped_files.h"
#include "experiments/tuning/tune.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <new>
#include <type_traits>

namespace gib {

namespace {

constexpr int exit_wrong_input = 2;
constexpr const char* scene_help = "a scene file (Mitsuba 3 XML), or a name that `gibench list scenes` prints";
constexpr const char* experiment_file_help =
    "the experiment file (TOML), or a name that `gibench list experiments` prints";
constexpr const char* epsilon_help =
    "epsilon of relative errors [radiance^2] (default: (0.1 m)^2, m the mean luminance of the reference)";

/// The work of the chosen subcommand, which returns the exit code. It is set while parsing and run afterwards.
using Action = std::function<int()>;

/// An option that may be given several times, each time with one value.
void may_be_repeated(CLI::Option* option) { option->take_all()->allow_extra_args(false); }

void add_threads(CLI::App* command, int& threads) {
    command->add_option("--threads", threads, "number of threads that compute (default: one per processor)")
        ->check(CLI::Range(1, most_threads));
}

void add_folders(CLI::App* command, std::vector<std::string>& folders) {
    may_be_repeated(command->add_option("-a", folders,
                                        "DIR: searched for the scene's files after the scene's own folder; several are "
                                        "searched in turn"));
}

void add_resolution(CLI::App* command, std::optional<std::pair<int, int>>& resolution) {
    const auto resize = [&resolution](const std::string& text) { resolution = resolution_in(text); };
    command->add_option_function<std::string>("--resolution", resize,
                                              "WIDTHxHEIGHT: size of the image in pixels, instead of the film's");
}

/// The options that decide how a scene file is loaded.
void add_loading(CLI::App* command, SceneLoadOptions& loading) {
    const auto set = [&loading](const std::vector<std::string>& texts) { loading.parameters = assignments(texts); };
    may_be_repeated(command->add_option_function<std::vector<std::string>>(
        "--set", set, "NAME=VALUE: sets a $parameter of the scene file"));
    add_folders(command, loading.folders);
    add_resolution(command, loading.resolution);
}

/// Accepts whole numbers below 2^63. Larger ones are the seeds of references, and CLI11 alone would read -1 as the
/// largest of them.
CLI::Validator seed_text() {
    return CLI::Validator(
        [](std::string& text) {
            const auto seed = number_from<std::uint64_t>(text);
            const bool good = seed && *seed < (std::uint64_t{1} << 63);
            return good ? std::string() : "a seed is a whole number from 0 to 2^63 - 1, not '" + text + "'";
        },
        "SEED");
}

/// The last options of a command that computes something of one scene.
void add_job(CLI::App* command, SceneJob& job, const char* out_help,
             const char* seed_help = "seed of the random numbers (default 1)") {
    command->add_option("--seed", job.seed, seed_help)->check(seed_text());
    add_threads(command, job.threads);
    add_loading(command, job.loading);
    command->add_option("-o,--out", job.out, out_help)->required();
}

/// Who runs the cells of an experiment.
struct ExecutorOptions {
    std::string name = "local";
    SlurmOptions slurm;
    std::vector<std::string> job;  ///< of run_job(): this process is a job
};

void add_executor(CLI::App* command, ExecutorOptions& executor) {
    command->add_option(
        "--on", executor.name,
        "local (default): run in this process; slurm: submit the same work as jobs of Slurm and return; "
        "the same command submits what is missing");
    command->add_option("--sbatch", executor.slurm.sbatch,
                        "with --on slurm: options for sbatch, such as \"--partition=short --time=60\"");
    command
        ->add_option("--tasks", executor.slurm.most_tasks,
                     "with --on slurm: tasks of an array job at most (default 256); each takes an even share of the "
                     "cells")
        ->check(CLI::Range(1, 1000000));
    command->add_option("--job", executor.job, "internal: does the work of a job of Slurm, see submit.h")
        ->expected(1, 2)
        ->group("");
}

int run_on(ExecutorOptions executor, const RunOptions& options) {
    executor.slurm.user_options = CLI::detail::split_up(executor.slurm.sbatch);  // as a shell would
    if (!executor.job.empty()) return run_job(options, executor.slurm, executor.job, std::cout);
    if (executor.name == "local") {
        if (!executor.slurm.sbatch.empty()) throw InputError("--sbatch is for --on slurm");
        if (executor.slurm.most_tasks != SlurmOptions().most_tasks) throw InputError("--tasks is for --on slurm");
        require_no_jobs(options);
        return run_or_tune(options, std::cout);
    }
    if (options.share) throw InputError("--share is for runs without --on slurm, which makes shares itself");
    if (executor.name != "slurm") reject({}, "--on knows no '{}'; there are: local, slurm", executor.name);
    if (load_tune_file(options.experiment))
        throw InputError({options.experiment},
                         "--on slurm is for experiments without [tune], whose runs follow from each other");
    return submit_run(options, executor.slurm, std::cout);
}

/// Makes `work(*options)` the action of a command, whose exit code is 0 if that returns none. The options live as long
/// as the command.
template <typename Options, typename Work>
void perform_with(const std::shared_ptr<Options>& options, CLI::App* command, Action& action, Work work) {
    command->callback([=, &action] {
        action = [=] {
            if constexpr (std::is_void_v<decltype(work(*options))>) {
                work(*options);
                return 0;
            } else {
                return work(*options);
            }
        };
    });
}

void add_run(CLI::App& app, Action& action, const std::string& command_line) {
    auto options = std::make_shared<RunOptions>();
    options->command_line = command_line;
    CLI::App* command = app.add_subcommand("run", "run an experiment file: references, cells, tables, report");
    auto repeated = std::make_shared<std::string>();
    CLI::Option* file = command->add_option("EXPERIMENT", options->experiment, experiment_file_help);
    command->add_option(
        "--out", options->out,
        "folder of the results (default: results/<experiment's name>; with --repeat, RESULT_DIR-repeat)");
    add_threads(command, options->threads);
    command->add_option("--seeds", options->seeds, "run seeds 1 to this number instead of the file's")
        ->check(CLI::Range(1, most_seeds));
    command->add_option("--only", options->only, "keep the cells whose scene, label or short name contains this text");
    command->add_flag("--quiet", options->quiet, "print warnings and errors only: no progress, no verdict");
    command->add_flag("--fresh", options->fresh,
                      "delete the measurements of the selected cells and measure them again (references are kept, "
                      "unless the scene's content has changed)");
    command->add_option_function<std::string>(
        "--share", [options](const std::string& text) { options->share = share_in(text); },
        "I/N: run only the cells number I, I + N, I + 2 N, ... of the experiment, counted from 0; N machines that "
        "share the folder of the results and results/references run one share each; the same command without --share "
        "makes the tables");
    CLI::Option* repeat = command->add_option(
        "--repeat", *repeated,
        "RESULT_DIR: render every complete cell of these results again, with as many passes as it "
        "made, and compare the images bit for bit; replaces the experiment file; exit code 0 if all "
        "are identical");
    auto executor = std::make_shared<ExecutorOptions>();
    add_executor(command, *executor);
    for (CLI::Option* other : command->get_options())
        if (other != repeat && other->get_name() != "--help" && other->get_name() != "--out") repeat->excludes(other);
    command->footer("The keys of an experiment file (TOML):\n" + key_help());
    command->callback([=, &action] {
        if (!*file && !*repeat) throw CLI::RequiredError("EXPERIMENT or --repeat");
        action = [=] {
            if (*repeat) return repeat_run(*repeated, *options, std::cout);
            options->experiment = experiment_file(options->experiment);
            return run_on(*executor, *options);
        };
    });
}

void add_render(CLI::App& app, Action& action) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "render a scene once");
    command->add_option("SCENE", options->scene, scene_help)->required();
    command->add_option("--method", options->method, "name and parameters of the method, such as \"path spp=64\"")
        ->required();
    add_job(command, *options, "the image (EXR)");
    command->add_flag(
        "--features", options->features,
        "add layers for filters: albedo, normal and depth of the first surface, mirrors and glass included");
    command->footer("Methods and their parameters:\n" + parameter_help());
    perform_with(options, command, action, [](const auto& o) { return render(o, std::cout); });
}

void add_reference(CLI::App& app, Action& action) {
    auto options = std::make_shared<ReferenceOptions>();
    options->method = auto_reference;
    CLI::App* command = app.add_subcommand("reference", "make a reference with a known error, or add samples to one");
    command->add_option("SCENE", options->scene, scene_help)->required();
    command->add_option(
        "--method", options->method,
        "name and parameters of the method, without spp (default \"auto\", which combines all unbiased methods)");
    command->add_option("--target", options->target,
                        "relative standard error to reach, such as 0.5% (default 1%, unless --max-seconds is given)");
    command->add_option("--max-seconds", options->seconds,
                        "stop after the round of passes during which this time is used up, even if the target is not "
                        "reached; one round of 16 batches always completes");
    command->add_option("--epsilon", options->epsilon, epsilon_help);
    add_job(command, *options, "the reference (EXR); an existing one gets more samples",
            "references of different seeds are independent (default 1)");
    command->add_flag("--replace", options->replace,
                      "replace an image at -o that is not the reference of this scene, method and size");
    perform_with(options, command, action, [](const auto& o) { return make_reference_file(o, std::cout); });
}

void add_compare(CLI::App& app, Action& action) {
    auto options = std::make_shared<CompareOptions>();
    auto files = std::make_shared<std::vector<std::string>>();
    CLI::App* command = app.add_subcommand("compare", "measure the error of images against a reference");
    command->add_option("IMAGES", *files, "TEST.exr [TEST.exr ...] REFERENCE.exr; several tests are replicates")
        ->required()
        ->expected(2, 1 << 20);
    command->add_option("--epsilon", options->epsilon, epsilon_help);
    command->add_flag("--json", options->json, "print JSON");
    command->add_option(
        "--png", options->png,
        "file for a picture of the first image's difference: blue is darker than the reference, red brighter");
    command->add_flag("--other-scene", options->other_scene,
                      "compare images of another scene, or of another version of it, than the reference's, too");
    command->add_flag(
        "--z-test", options->z_test,
        "test whether the images differ from the reference by noise alone: exit code 0 accepted, 1 rejected. Accepted "
        "if no block of 8 x 8 or 64 x 64 pixels and no whole image differs in any channel or component (1 % "
        "for all tests together, with the noise of both sides) and if the 95 % interval of the mean's deviation lies "
        "within 0.2 %");
    perform_with(options, command, action, [files](CompareOptions& o) {
        o.reference = files->back();
        o.tests.assign(files->begin(), files->end() - 1);
        return compare(o, std::cout);
    });
}

void add_plan(CLI::App& app, Action& action) {
    struct Options {
        std::string scene, method;
        SceneLoadOptions loading;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "plan", "show which light transport a scene calls for, and what a method simulates and leaves out");
    command->add_option("SCENE", options->scene, scene_help)->required();
    command->add_option("--method", options->method,
                        "name of the method, with or without parameters (default: every method)");
    add_loading(command, options->loading);
    perform_with(options, command, action,
                 [](const auto& o) { return print_plan(o.scene, o.method, o.loading, std::cout); });
}

void add_list(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand(
        "list", "list methods, scenes, effects, experiments, keys or columns, one a line, the name first");
    command->require_subcommand(1);
    // `print` gets whether the flag is given.
    const auto add_with_flag = [&](const char* kind, const char* sentence, const char* flag, const char* flag_help,
                                   void (*print)(bool, std::ostream&)) {
        auto is_given = std::make_shared<bool>(false);
        CLI::App* list = command->add_subcommand(kind, sentence);
        list->add_flag(flag, *is_given, flag_help);
        perform_with(is_given, list, action, [=](bool given) { print(given, std::cout); });
    };
    const auto add = [&](const char* kind, const char* sentence, void (*print)(std::ostream&)) {
        command->add_subcommand(kind, sentence)->callback([&action, print] {
            action = [print] {
                print(std::cout);
                return 0;
            };
        });
    };
    add_with_flag("methods", "methods that can be run", "--parameters",
                  "show every parameter with its unit, range and default, too", list_methods);
    add("scenes", "scenes that come with the program", list_scenes);
    add("effects", "kinds of light transport", list_effects);
    add("experiments", "experiments that come with the program", list_experiments);
    constexpr const char* markdown_help = "print this part of experiments/REFERENCE.md";
    add_with_flag("keys", "keys of an experiment file", "--markdown", markdown_help, list_keys);
    add_with_flag("columns", "columns of the CSV files of a result folder", "--markdown", markdown_help, list_columns);
}

void add_completion(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("completion", "print a script that completes the command line in a shell");
    command->require_subcommand(1);
    command->add_subcommand("bash", "for bash: source <(gibench completion bash)")->callback([&] {
        action = [&app] {
            std::cout << bash_completion(app);
            return 0;
        };
    });
}

template <typename Work>
void add_of_folder(CLI::App& app, Action& action, const char* name, const char* sentence, Work work) {
    auto folder = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand(name, sentence);
    command->add_option("RESULT_DIR", *folder, "a folder of results")->required();
    perform_with(folder, command, action, [work](const auto& path) { return work(path, std::cout); });
}

void add_compare_runs(CLI::App& app, Action& action) {
    auto options = std::make_shared<CompareRunsOptions>();
    CLI::App* command = app.add_subcommand(
        "compare-runs", "say which methods have become better or worse from one run of an experiment to another");
    command->add_option("OLD", options->before, "a folder of results")->required();
    command->add_option("NEW", options->after, "a folder of results of the same scenes")->required();
    command->add_flag("--csv", options->csv, "print CSV");
    command->add_flag("--fail-if-worse", options->fail_if_worse,
                      "exit code 1 if a number is worse, or none is compared");
    perform_with(options, command, action, [](const auto& o) { return compare_runs(o, std::cout); });
}

void add_photons(CLI::App& app, Action& action) {
    auto options = std::make_shared<PhotonsOptions>();
    CLI::App* command = app.add_subcommand(
        "photons", "write a page that shows photons, irradiance records or radiosity patches in the scene in 3D");
    command->add_option("SCENE", options->scene, scene_help)->required();
    command
        ->add_option("--method", options->method,
                     "name and parameters of a method that stores light, such as \"photon_mapper photons=1e5\", "
                     "progressive_photon_mapper or radiosity")
        ->required();
    command
        ->add_option("--photons-shown", options->most_photons,
                     "photons on the page at most (default 200000): a uniform subset of each map, in even shares")
        ->check(CLI::Range(std::size_t{1}, most_photons_shown));
    command
        ->add_option(
            "--passes", options->passes,
            "passes at most of a method that stores other light in each, and of its image (default: its spp, at "
            "most 16; of an image beside light that stays, at most 4)")
        ->check(CLI::Range(1u, most_passes_shown));
    add_job(command, *options, "the page (HTML)");
    perform_with(options, command, action, [](const auto& o) { return show_photons(o, std::cout); });
}

void add_tune(CLI::App& app, Action& action, const std::string& command_line) {
    struct Options {
        std::string scene;
        TuneFile file;
        std::vector<std::string> variations;
        RunOptions run;
    };
    auto options = std::make_shared<Options>();
    TuneFile& file = options->file;
    options->run.command_line = command_line;
    CLI::App* command = app.add_subcommand("tune", "search the settings of methods with the least time to an error");
    command->add_option("SCENE", options->scene, scene_help)->required();
    command->add_option("--target", file.target, "relative RMSE to reach (default 2%)");
    may_be_repeated(command->add_option(
        "--method", file.methods,
        "NAME or label of a method, whose given parameters stay; several may be given (default: every "
        "method)"));
    may_be_repeated(command->add_option(
        "--vary", options->variations,
        "PARAMETER=FROM..TO or PARAMETER=A,B: what to search, besides the parameters that declare a span "
        "(see list methods --parameters)"));
    command
        ->add_option("--minutes", file.minutes,
                     "time for reference, search and final runs (default 20); no run begins later")
        ->check(CLI::PositiveNumber);
    command->add_option("--epsilon", file.head.epsilon, epsilon_help);
    command->add_option("--out", options->run.out, "folder of the results (default: results/tune-SCENE)");
    add_folders(command, file.head.paths);
    add_resolution(command, file.head.resolution);
    add_threads(command, options->run.threads);
    perform_with(options, command, action, [](Options o) {
        for (const auto& text : o.variations)
            o.file.variations.push_back({text, {}});
        check_out(o.run);
        ExperimentScene scene;
        scene.path = scene_file(o.scene);
        scene.name = std::filesystem::path(scene.path).stem().string();
        o.run.out = result_folder_of(o.run.out, "tune-" + scene.name);
        return tune(o.file, scene, o.run, std::cout);
    });
}

/// Adds an internal subcommand that `run` starts for each cell. An empty group hides it from the help.
void add_internal(CLI::App& app, Action& action, const char* name, const char* sentence,
                  void (*measure)(const std::string&)) {
    auto request = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand(name, sentence)->group("");
    command->add_option("REQUEST", *request, "request.json of a cell's work folder")->required();
    perform_with(request, command, action, measure);
}

int perform(const Action& action) {
    try {
        const int code = action();
        std::cout.flush();
        if (!std::cout) throw RunError("cannot write to standard output");
        return code;
    } catch (const InputError& error) {
        std::cerr << error.what() << "\n";
        return exit_wrong_input;
    } catch (const Interrupted& error) {
        std::cerr << error.what() << "\n";
        return exit_interrupted;
    } catch (const std::bad_alloc&) {
        std::cerr << "out of memory\n";
        return exit_failed;
    } catch (const std::exception& error) {
        std::cerr << error.what() << "\n";
        return exit_failed;
    }
}

}  // namespace

int run_program(int argc, char** argv) {
    std::string command_line;
    for (int i = 0; i < argc; ++i)
        command_line += (i > 0 ? " " : "") + std::string(argv[i]);
    Action action;
    CLI::App app("gibench: what every step of accuracy costs in global illumination", "gibench");
    app.set_version_flag("--version", build_text());
    app.formatter(narrow_help());
    app.require_subcommand(1);
    add_run(app, action, command_line);
    add_render(app, action);
    add_reference(app, action);
    add_compare(app, action);
    add_plan(app, action);
    add_list(app, action);
    add_of_folder(app, action, "report", "make the tables and report.html again from stored results alone",
                  rebuild_report);
    add_of_folder(app, action, "status", "count a run's cells by state; exit code 1 if one has failed or is missing",
                  print_status);
    add_compare_runs(app, action);
    add_photons(app, action);
    add_tune(app, action, command_line);
    add_completion(app, action);
    add_internal(app, action, "measure-cell", "internal: measures one cell, see cell_process.h", measure_cell);
    add_internal(app, action, "measure-command", "internal: runs a command, see commands.h", measure_command);
    take_help_as_option(argc, argv);
    return perform([&] {
        try {
            app.parse(argc, argv);
        } catch (const CLI::ParseError& error) {
            // CLI11 has an exit code for each kind of mistake; here all of them mean that the command line is wrong.
            const bool asks = error.get_exit_code() == 0;
            const std::string wrong = asks ? "" : wrong_word(app, std::vector<std::string>(argv + 1, argv + argc));
            if (wrong.empty()) return app.exit(error) == 0 ? 0 : exit_wrong_input;
            std::cerr << wrong << "\nRun with --help for more information.\n";
            return exit_wrong_input;
        }
        return action();
    });
}

}  // namespace gib
