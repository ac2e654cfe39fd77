#pragma once
// Parses the command line and runs what it asks for.

namespace gib {

/// Runs the program. Exit codes: 0 done, 1 a run failed or a test did not accept, 2 the command line or a file is
/// wrong, 130 interrupted.
int run_program(int argc, char** argv);

}  // namespace gib
