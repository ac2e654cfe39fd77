#include "experiments/system/interrupt.h"

#include <atomic>

namespace gib {

namespace {

// This is the only global variable of the program, because a signal handler can reach nothing else. It is atomic
// because other threads read it too.
std::atomic<bool> interrupt_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");

void request_interrupt(int) { interrupt_requested = true; }

}  // namespace

InterruptGuard::InterruptGuard() {
    interrupt_requested = false;
    struct sigaction action = {};
    action.sa_handler = request_interrupt;
    sigemptyset(&action.sa_mask);
    // SA_RESTART keeps output that waits for its reader from failing. poll and sleep return early in spite of it.
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
}

InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
}

bool InterruptGuard::requested() { return interrupt_requested; }

void InterruptGuard::check() {
    if (requested()) throw Interrupted();
}

}  // namespace gib
