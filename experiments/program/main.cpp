#include "common/core/float_traps.h"
#include "experiments/program/command_line.h"

#include <fcntl.h>
#include <unistd.h>
#include <csignal>

namespace {

/// Opens /dev/null in place of each standard stream that is closed (`2>&-`). Otherwise the next file that is opened
/// would get the stream's number, and messages would go into that file. It is opened for reading only, so that
/// writing to a closed standard output still fails.
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
    std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is then an error with a message
    return gib::run_program(argc, argv);
}
