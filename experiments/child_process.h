#pragma once
// Starting a program, listening to it, and stopping it when the user asks to.

#include <functional>
#include <string>
#include <vector>

namespace gib {

/// Runs a program to its end. Its standard output is handed over line by line, its standard error is kept in memory.
/// Throws RunError, with the child's last message, if it cannot be started, fails or is killed;
/// Interrupted, after stopping it, on Ctrl-C (see InterruptGuard).
void run_child(const std::vector<std::string>& arguments, const std::function<void(const std::string& line)>& on_line);

/// Makes the kernel end this process when the one that started it dies, so that no cell goes on without a run that
/// wants it. Throws RunError if that was not `parent`, which then is dead already; 0: whichever it is.
void die_with_parent(int parent = 0);

}  // namespace gib
