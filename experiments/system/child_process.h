#pragma once
// Runs another program: starts it, reads its output, and stops it when the user asks for that.

#include <functional>
#include <string>
#include <vector>

namespace gib {

/// Runs a program to its end. Each line of its standard output is passed to `on_line`; its standard error is kept in
/// memory. Throws RunError if it cannot be started and, with its last message, if it fails or is killed; Interrupted on
/// Ctrl-C, after it has been stopped (see InterruptGuard).
void run_child(const std::vector<std::string>& arguments, const std::function<void(const std::string& line)>& on_line);

/// Makes the kernel end this process when its parent dies, so that no cell goes on without its run. Throws RunError
/// if the parent is not the process `parent`, which then has died already.
void die_with_parent(int parent);

}  // namespace gib
