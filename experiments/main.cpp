#include "common/float_traps.h"
#include "experiments/command_line.h"

int main(int argc, char** argv) {
    gib::trap_floating_point_errors();
    return gib::run_program(argc, argv);
}
