#pragma once
// An experiment file with `[tune]` (`gibench run`): the search of `gibench tune` for each of its scenes.

#include "experiments/plan/run_options.h"
#include "experiments/plan/tune_file.h"

#include <iosfwd>

namespace gib {

/// Tunes each scene in the folder NAME of the results, where NAME is the scene's, and prints each one's findings to
/// `out`. Of `options`, the folder, the threads and `only` count, which keeps the scenes whose names contain it. Returns the
/// exit code: 0 found for all scenes, 1 not for each of them, 130 interrupted. Throws InputError, before anything is computed,
/// if the file or an option is wrong.
int tune_experiment(const TuneFile& file, const RunOptions& options, std::ostream& out);

/// Runs an experiment file as `gibench run` does, with or without `[tune]`. Returns the exit code.
int run_or_tune(const RunOptions& options, std::ostream& out);

}  // namespace gib
