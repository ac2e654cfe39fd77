#pragma once
// Repeats a run (`gibench run --repeat RESULT_DIR`): renders every complete cell again, with exactly as many passes
// and threads, into another result folder. The images have to be identical bit for bit.

#include "experiments/plan/run_options.h"

#include <iosfwd>
#include <string>

namespace gib {

/// Repeats the run in the folder `results`, which is only read, and prints a line for each cell to `out`. The options
/// that count are the folder of the new results (by default `results` + "-repeat") and the command line. Returns the
/// exit code: 0 if all are identical, 1 if one is not or could not be rendered, 130 if interrupted. Throws InputError,
/// before anything is computed, if the manifest cannot be repeated or a scene was changed. Another commit, compiler,
/// library or processor only gives a warning.
int repeat_run(const std::string& results, RunOptions options, std::ostream& out);

}  // namespace gib
