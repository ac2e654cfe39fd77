#include "experiments/interrupt.h"

namespace gib {

namespace {

// The program's one global: a signal handler can reach nothing else.
volatile std::sig_atomic_t interrupt_requested = 0;

void request_interrupt(int) { interrupt_requested = 1; }

}  // namespace

InterruptGuard::InterruptGuard() {
    interrupt_requested = 0;
    struct sigaction action = {};
    action.sa_handler = request_interrupt;
    sigemptyset(&action.sa_mask);
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
}

InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
}

bool InterruptGuard::requested() { return interrupt_requested != 0; }

void InterruptGuard::check() {
    if (requested()) throw Interrupted();
}

}  // namespace gib
