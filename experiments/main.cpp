#include "common/float_traps.h"
#include "experiments/command_line.h"

#include <csignal>

int main(int argc, char** argv) {
    gib::trap_floating_point_errors();
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error with a message, not the end
    return gib::run_program(argc, argv);
}
