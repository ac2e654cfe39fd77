#pragma once
// Finds the settings of each method with the least time to an error (`gibench tune`).

#include "experiments/plan/experiment_file.h"
#include "experiments/plan/run_options.h"

#include <iosfwd>

namespace gib {

/// Searches on one scene, measures the best settings with fresh seeds and prints them to `out`, the best label first
/// and a line with the verdict of each method last. The folder options.out gets tables and the report of the final
/// runs, with
/// `tune.json` (tuning_result.h) and a section about the search. The same command goes on after an interruption. Returns the
/// exit code: 0 found, 1 no method reached the target, or the reference's noise hides it. Throws InputError, and
/// Interrupted.
int tune(const TuneFile& file, const ExperimentScene& scene, const RunOptions& options, std::ostream& out);

/// Runs an experiment file as `gibench run` does, with or without `[tune]`. With it, each scene whose name contains
/// options.only is tuned in a folder of its name. Returns the exit code. Throws InputError, before anything is
/// computed, if the file or an option is wrong.
int run_or_tune(const RunOptions& options, std::ostream& out);

}  // namespace gib
