#pragma once
// Starting a program, listening to it, and stopping it when the user asks to.

#include "common/core/error.h"

#include <functional>
#include <string>
#include <vector>

namespace gib {

/// A program that could not be started: no processes, no memory or no files are left. It says nothing about the
/// program.
class ChildNotStarted : public RunError {
public:
    using RunError::RunError;
};

/// Runs a program to its end. Its standard output is handed over line by line, its standard error is kept in memory.
/// Throws ChildNotStarted; RunError, with the child's last message, if it fails or is killed;
/// Interrupted, after stopping it, on Ctrl-C (see InterruptGuard).
void run_child(const std::vector<std::string>& arguments, const std::function<void(const std::string& line)>& on_line);

/// Makes the kernel end this process when the one that started it dies, so that no cell goes on without a run that
/// wants it. Throws RunError if that was not `parent`, which then is dead already; 0: whichever it is.
void die_with_parent(int parent = 0);

}  // namespace gib
