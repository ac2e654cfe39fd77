#pragma once
// Makes Ctrl-C a flag that long computations check, so that they can keep what is complete.

#include "common/core/error.h"

#include <csignal>

namespace gib {

/// The exit codes of a program that failed and of one that Ctrl-C ended.
inline constexpr int exit_failed = 1, exit_interrupted = 130;

/// Thrown where an interrupted computation cannot go on. The program then exits with exit_interrupted.
class Interrupted : public RunError {
public:
    Interrupted() : RunError("interrupted") {}
};

/// While a guard lives, the first SIGINT or SIGTERM only makes
/// requested() true; the second ends the program as usual.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    static bool requested();
    /// Throws Interrupted if requested.
    static void check();

private:
    struct sigaction old_int_, old_term_;
};

}  // namespace gib
