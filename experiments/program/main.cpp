#include "common/core/float_traps.h"
#include "experiments/program/command_line.h"

#include <fcntl.h>
#include <unistd.h>
#include <csignal>

namespace {

/// The number of a standard stream that is closed (`2>&-`) would go to the next file that is opened, and messages into
/// that file. Open for reading only, so that a standard output that is closed still cannot be written.
void occupy_standard_streams() {
    int file = 0;
    do
        file = ::open("/dev/null", O_RDONLY);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0) ::close(file);
}

}  // namespace

int main(int argc, char** argv) {
    occupy_standard_streams();
    gib::trap_floating_point_errors();
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error with a message, not the end
    return gib::run_program(argc, argv);
}
