#pragma once
// Runs an experiment (`gibench run`), from its file to its tables and report.

#include "experiments/plan/run_options.h"

#include <iosfwd>
#include <string>

namespace gib {

/// Throws InputError if the command line or the current folder's name is not UTF-8. The records of a run name both
/// and have to be UTF-8; without this check the first record would fail, after much is computed.
void require_utf8_names(const std::string& command_line);

/// Runs an experiment and returns the exit code: 0 done, 1 a cell or reference failed (stderr says which), 130
/// interrupted. Complete cells are kept and are in the tables in every case. Throws InputError, before anything is
/// computed or written, if the experiment is wrong.
int run_experiment(const RunOptions& options, std::ostream& out);

}  // namespace gib
