#pragma once
// An experiment file with `[tune]` asks for the cheapest settings on each of its scenes, as `gibench tune` does for one.

#include "experiments/plan/experiment_file.h"
#include "experiments/plan/run_options.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

struct TuneFile {
    Experiment head;  ///< title, scenes, paths, resolution and epsilon; without methods
    std::string target{default_tuning_target};
    std::vector<std::string> methods;  ///< labels; empty: every method
    struct Text {
        std::string text;
        SourceLocation where;
    };
    std::vector<Text> variations;             ///< such as "photons=1e4..1e7"
    double minutes = default_tuning_minutes;  ///< time for each scene
};

/// Reads an experiment file with `[tune]`; empty if it has none. Throws InputError (`file:line:column: message`) for
/// unknown keys, wrong types, unknown methods and parameters, and for keys of other experiments.
std::optional<TuneFile> load_tune_file(const std::string& path);
std::optional<TuneFile> parse_tune_file(const std::string& text, const std::string& path);

}  // namespace gib
