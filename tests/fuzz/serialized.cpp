// Mitsuba's serialized meshes. Of a file with several the second is read too.

#include "common/error.h"
#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    for (const int index : {0, 1}) {
        try {
            check_mesh(parse_serialized(input, "input.serialized", index).data);
        } catch (const InputError&) {
        }
    }
}

}  // namespace gib::fuzz
