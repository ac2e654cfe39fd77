#pragma once
// A run reads and checks all of this before it computes anything: the experiment, the facts about its scenes, and what
// the methods leave out in them.

#include "common/reader/scene_file.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/plan/run_options.h"
#include "experiments/results/layer.h"
#include "experiments/system/progress.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// The sayings of a run while it works: its line of progress, and what has failed.
struct RunLog {
    struct Failure {
        std::string of;  ///< cell or reference
        std::string message;

        std::string text() const { return of + ": " + message; }
    };

    ProgressLine progress;
    std::vector<Failure> failures;

    void fail(const std::string& of, const std::string& message) {
        failures.push_back({of, message});
        progress.message("failed: " + failures.back().text());
    }
    /// Says all failures again at the end of a run, and returns its exit code.
    int exit_code() const;
};

struct RunScene {
    ExperimentScene entry;
    std::string content_hash;
    std::map<std::string, std::string> attributes;  ///< scene_attributes()
    std::optional<int> sample_count;                ///< samples a pixel in the file's sampler
    int width = 0, height = 0;                      ///< size of its images [pixels]
};

struct RunSetup {
    Experiment experiment;
    int threads = 1;
    std::string command_line;           ///< RunOptions::command_line
    std::string build;                  ///< digest of this program
    std::vector<RunScene> scenes = {};  ///< in the experiment's order
    /// The effects and the light that methods leave out, as ResultIndex has them.
    std::map<std::pair<std::string, std::string>, LeftOut> left_out = {};

    /// Loads a scene again. Only one is in memory at a time. Throws RunError if it was changed since it was checked.
    LoadedScene load(const RunScene& scene) const;
};

/// Loads every scene and plans every method on it. `options` are those beside the experiment's file. Nothing is
/// written. Throws InputError.
RunSetup checked_setup(Experiment experiment, const RunOptions& options);

/// Whether `--only TEXT` keeps the cells of a method on a scene: TEXT is in the scene's name, in the method's label, or
/// in the name that the experiment file gives it, with its settings as in tables ("photon map, photons=1e5").
bool is_kept(const std::string& only, const Experiment& experiment, const std::string& scene,
             const MethodLabel& method);

}  // namespace gib
