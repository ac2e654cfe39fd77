#include "experiments/system/interrupt.h"

#include <atomic>

namespace gib {

namespace {

// The program's one global: a signal handler can reach nothing else. Other threads than the handler's ask for it too.
std::atomic<bool> interrupt_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");

void request_interrupt(int) { interrupt_requested = true; }

}  // namespace

InterruptGuard::InterruptGuard() {
    interrupt_requested = false;
    struct sigaction action = {};
    action.sa_handler = request_interrupt;
    sigemptyset(&action.sa_mask);
    // Restarted: output that waits for its reader does not fail. What polls and sleeps ends early all the same.
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
