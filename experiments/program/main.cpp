#include "common/core/float_traps.h"
#include "experiments/program/command_line.h"

#include <csignal>

int main(int argc, char** argv) {
    gib::trap_floating_point_errors();
    std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is then an error with a message
    return gib::run_program(argc, argv);
}
