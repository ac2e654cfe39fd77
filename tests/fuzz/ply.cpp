// PLY meshes.

#include "common/error.h"
#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    try {
        check_mesh(parse_ply(input, "input.ply"));
    } catch (const InputError&) {
    }
}

}  // namespace gib::fuzz
