#pragma once
// `gibench run`: an experiment from its file to its tables and report.

#include "experiments/plan/run_options.h"

#include <iosfwd>
#include <string>

namespace gib {

/// Throws InputError if the command line or the current folder's name is not UTF-8, as the records of a run, which name
/// both, have to be: the first record would notice, when much is computed.
void require_utf8_names(const std::string& command_line);

/// Exit code: 0 done, 1 a cell failed (said on stderr), 130 interrupted; what is complete is kept and in the tables.
/// Throws InputError, before anything is computed or written, for whatever is wrong with the experiment.
int run_experiment(const RunOptions& options, std::ostream& out);

}  // namespace gib
