// The fuzz target of PLY meshes.

#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    unless_refused([&] { check_mesh(parse_ply(input, "input.ply")); });
}

}  // namespace gib::fuzz
