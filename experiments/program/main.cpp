#include "common/core/float_traps.h"
#include "experiments/program/command_line.h"

#include <malloc.h>
#include <sys/mman.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>

namespace {

/// Prepares the heap for images, which are allocated and freed often: the allocator keeps blocks of up to 4 MiB instead
/// of returning their pages to the system and faulting them in again, and its first 16 MiB use huge pages.
/// tests/bench/README.md has what this is worth.
void prepare_heap() {
    constexpr std::size_t reserved = 16 << 20;
    constexpr std::uintptr_t page = 2 << 20;
    mallopt(M_MMAP_THRESHOLD, 2 * reserved);
    mallopt(M_TRIM_THRESHOLD, reserved + (4 << 20));
    if (void* block = std::malloc(reserved)) {
        const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(block) + page - 1) / page * page;
        // The pages take no memory until they are used. The system may refuse, which costs only time.
        madvise(reinterpret_cast<void*>(begin), reserved - page, MADV_HUGEPAGE);
        std::free(block);
    }
    mallopt(M_MMAP_THRESHOLD, 4 << 20);
}

}  // namespace

int main(int argc, char** argv) {
    prepare_heap();
    gib::trap_floating_point_errors();
    std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is then an error with a message
    return gib::run_program(argc, argv);
}
