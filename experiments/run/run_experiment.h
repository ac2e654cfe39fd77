#pragma once
// Runs an experiment (`gibench run`), from its file to its tables and report, or a share of its cells.

#include "experiments/plan/run_options.h"

#include <iosfwd>

namespace gib {

/// Checks before anything is loaded that the folder of --out can be made (InputError), and says on stderr that it will
/// be made below one that is not there, which may be mistyped.
void check_out(const RunOptions& options);

/// Runs an experiment and returns the exit code: 0 done, 1 a cell or reference failed (stderr says which), 130
/// interrupted. Complete cells are kept and are in the tables in every case. A share leaves tables to the run without
/// one that follows it. Throws InputError, before anything is computed or written, if the experiment is wrong; RunError
/// at the end if cells are lacking because a share that has begun meanwhile has taken them.
int run_experiment(const RunOptions& options, std::ostream& out);

}  // namespace gib
