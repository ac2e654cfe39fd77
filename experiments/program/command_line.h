#pragma once
// The program's command line.

namespace gib {

/// Runs the program. Exit codes: 0 done, 1 a run failed, 2 the command line or a file is wrong, 130 interrupted.
int run_program(int argc, char** argv);

}  // namespace gib
