#pragma once
// Ctrl-C as a question that long work asks itself, so that what is complete can be kept.

#include "common/core/error.h"

#include <csignal>

namespace gib {

/// Thrown where an interrupted computation cannot go on; the program exits with 130.
class Interrupted : public RunError {
public:
    Interrupted() : RunError("interrupted") {}
};

/// While it lives, the first SIGINT or SIGTERM only makes requested() true; the second ends the program as usual.
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
