#pragma once
// What `gibench tune` is asked for, on its command line or by an experiment file with `[tune]`, which asks for each of its scenes.

#include "experiments/plan/experiment_file.h"
#include "experiments/plan/run_options.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

struct TuneFile {
    Experiment head;                            ///< title, scenes, paths, resolution and epsilon; without methods
    std::string target{default_tuning_target};  ///< relative RMSE
    std::vector<std::string> methods;           ///< labels; empty: every method
    struct Text {
        std::string text;
        SourceLocation where;
    };
    std::vector<Text> variations;             ///< such as "photons=1e4..1e7"
    double minutes = default_tuning_minutes;  ///< time for reference, search and final runs of a scene
};

/// Reads an experiment file with `[tune]`; empty if it has none. Throws InputError (`file:line:column: message`) for
/// unknown keys, wrong types, unknown methods and parameters, and for keys of other experiments.
std::optional<TuneFile> load_tune_file(const std::string& path);
std::optional<TuneFile> parse_tune_file(const std::string& text, const std::string& path);

}  // namespace gib
