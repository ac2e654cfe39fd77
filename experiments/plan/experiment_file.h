#pragma once
// An experiment file says which scenes are rendered with which methods, how often and for how long, and with what
// references they are compared.
//
// A tuning is asked for on the command line of `gibench tune`, or for each of its scenes by an experiment file with
// `[tune]`.

#include "common/core/error.h"
#include "experiments/plan/external_method.h"
#include "experiments/plan/label_checks.h"
#include "experiments/plan/run_options.h"
#include "methods/parameters.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// The limits at which a cell ends, besides its `spp`: the first one that is reached counts. If neither is given,
/// `spp` alone counts.
struct Budget {
    std::optional<double> seconds;  ///< charged wall-clock seconds
    std::optional<std::uint32_t> passes;
};

/// The conditions under which a reference is good enough; the first one that is met counts.
struct ReferenceGoal {
    /// Relative standard error of the total, a fraction; empty: `seconds` alone decides.
    std::optional<double> target;
    /// Wall-clock seconds after which the reference is taken as it is.
    std::optional<double> seconds;
};

struct ExperimentScene {
    std::string path;     ///< as the program opens it
    std::string written;  ///< as in the experiment file
    std::string name;     ///< the file's name without folder and extension
    SourceLocation where;
    ReferenceGoal goal;
    /// The path of an image that is the reference, as the program opens it; empty: gibench makes the reference.
    std::string reference_image = {};
    std::vector<std::string> reference_replicates = {};  ///< further images of the same reference, from other seeds
};

struct Experiment : ExperimentMethods {
    std::string path;
    std::string name;  ///< name of the file, without folder and extension
    std::string text;  ///< the whole file
    std::string title;
    std::vector<ExperimentScene> scenes;
    std::vector<std::string> paths;  ///< folders that are searched for the scenes' files, as the program opens them
    std::optional<std::pair<int, int>> resolution;  ///< width, height instead of the scenes' own
    int seeds = default_seeds;                      ///< number of seeds, which are 1 to this
    /// The epsilon of relative errors [radiance^2]; none: relative to each reference, the default (epsilon.h).
    std::optional<double> epsilon;
    Budget budget;
    MethodLabel reference_method;

    /// The command of a label; null for a method of gibench.
    const ExternalMethod* external(const MethodLabel& label) const {
        const auto found = externals.find(label.text());
        return found == externals.end() ? nullptr : &found->second;
    }
    /// The command that filters a label's images; null: none does.
    const ExternalMethod* filter_command(const MethodLabel& label) const {
        const auto found = filters.find(filter_of(label));
        return found == filters.end() ? nullptr : &found->second;
    }
};

/// Reads an experiment file. Throws InputError (`file:line:column: message`) for unknown keys, wrong types, unknown
/// methods and parameters, values out of range and scene files that do not exist.
Experiment load_experiment(const std::string& path);

/// Reads an experiment from the text of its file; scenes are searched in the folder of `path`. Throws the same errors
/// as load_experiment().
Experiment parse_experiment(const std::string& text, const std::string& path);

/// Whether the text of an experiment file gives a budget in seconds. Of a text that is no experiment, nothing is known:
/// true.
bool has_time_budget(const std::string& text);

/// The fraction that a text such as "1%" or "0.01" gives. Throws InputError at `where` unless it lies in (0, 1).
double parse_target(const std::string& text, const SourceLocation& where = {});

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
