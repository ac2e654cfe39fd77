#pragma once
// Runs an experiment (`gibench run`), from its file to its tables and report, or a share of its cells.
//
// Repeats a run (`gibench run --repeat RESULT_DIR`): renders every complete cell again, with exactly as many passes
// and threads, into another result folder. The images have to be identical bit for bit.

#include "experiments/plan/run_options.h"

#include <iosfwd>

namespace gib {

/// Checks before anything is loaded that the folder of --out can be made (InputError), and says on stderr that it will be made
/// below one that is not there, which may be mistyped.
void check_out(const RunOptions& options);

/// Runs an experiment and returns the exit code: 0 done, 1 a cell or reference failed (stderr says which), 130
/// interrupted. Complete cells are kept and are in the tables in every case. A share leaves tables to the run without one
/// that follows it. Throws InputError, before anything is computed or written, if the experiment is wrong; RunError at the
/// end if cells are lacking because a share that has begun meanwhile has taken them.
int run_experiment(const RunOptions& options, std::ostream& out);

/// Repeats the run in the folder `results`, which is only read, and prints a line for each cell to `out`. The options that
/// count are the folder of the new results (by default `results` + "-repeat") and the command line. Returns the exit code: 0
/// if all are identical, 1 if one is not or could not be rendered, 130 if interrupted. Throws InputError, before anything is
/// computed, if the manifest cannot be repeated or a scene was changed. Another commit, compiler, library or processor only
/// gives a warning.
int repeat_run(const std::string& results, RunOptions options, std::ostream& out);

}  // namespace gib
