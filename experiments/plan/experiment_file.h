#pragma once
// Experiment files: which scenes are rendered with which methods, how often and for how long, and against what they are
// measured.

#include "common/core/error.h"
#include "experiments/plan/epsilon.h"
#include "methods/method.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// When a cell ends, besides its `spp`; the first that is reached counts. Neither: `spp` alone.
struct Budget {
    std::optional<double> seconds;  ///< charged wall-clock seconds
    std::optional<std::uint32_t> passes;
};

/// How good a reference has to be.
struct ReferenceGoal {
    std::optional<double>
        target;  ///< relative standard error of the total (a fraction); empty: `seconds` alone decides
    std::optional<double> seconds;  ///< wall-clock seconds after which it is taken as it is
};

struct ExperimentScene {
    std::string path;     ///< as the program opens it
    std::string written;  ///< as it stands in the experiment file
    std::string name;     ///< the file's name without folder and extension
    SourceLocation where;
    ReferenceGoal goal;
};

struct Experiment {
    std::string path;
    std::string name;  ///< of the file, without folder and extension
    std::string text;  ///< the whole file
    std::string title;
    std::vector<ExperimentScene> scenes;
    std::optional<std::pair<int, int>> resolution;  ///< width, height instead of the scenes' own
    int seeds = 1;                                  ///< seeds 1 to this
    double epsilon = default_epsilon;               ///< of relative errors [radiance^2]
    Budget budget;
    MethodLabel reference_method;
    std::vector<MethodLabel> methods;  ///< sweeps expanded, in the order of the file
};

/// Throws InputError (`file:line:column: message`) for unknown keys, wrong types, unknown methods and parameters,
/// values out of range and scene files that do not exist.
Experiment load_experiment(const std::string& path);

/// The same for text in memory; scenes are searched in the folder of `path`.
Experiment parse_experiment(const std::string& text, const std::string& path);

/// "1%" or "0.01" as a fraction. Throws InputError at `where` unless it lies in (0, 1).
double parse_target(const std::string& text, const SourceLocation& where = {});

}  // namespace gib
