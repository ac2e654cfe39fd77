// The fuzz target of Mitsuba's serialized meshes. The second mesh of a file is read too.

#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    for (const int index : {0, 1})
        unless_refused([&] { check_mesh(parse_serialized(input, "input.serialized", index).data); });
}

}  // namespace gib::fuzz
