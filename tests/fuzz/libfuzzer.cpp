// The function that libFuzzer calls for each input; libFuzzer has the main() and the loop.

#include "tests/fuzz/harness.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    gib::fuzz::run_input({reinterpret_cast<const char*>(data), size});
    return 0;
}
