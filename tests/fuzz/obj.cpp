// The fuzz target of OBJ meshes.

#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    unless_refused([&] { check_mesh(parse_obj(input, "input.obj")); });
}

}  // namespace gib::fuzz
