// OBJ meshes.

#include "common/error.h"
#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    try {
        check_mesh(parse_obj(input, "input.obj"));
    } catch (const InputError&) {
    }
}

}  // namespace gib::fuzz
