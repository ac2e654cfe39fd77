// The fuzz target of Mitsuba's serialized meshes. An input is a file, and also the content of a mesh that is compressed
// here: mutated bytes of a file would nearly all end at zlib's checksum. The second mesh of a file is read too.

#include "tests/fuzz/harness.h"

#include <zlib.h>

namespace gib::fuzz {

namespace {

/// The file of one mesh of version 4 with this content.
std::string file_of(std::string_view content) {
    uLongf size = compressBound(content.size());
    std::string packed(size, '\0');
    require(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
                     content.size()) == Z_OK,
            "the content is compressed");
    return std::string("\x1c\x04\x04\0", 4) + packed.substr(0, size);
}

}  // namespace

void run_input(std::string_view input) {
    for (const int index : {0, 1})
        unless_refused([&] { check_mesh(parse_serialized(input, "input.serialized", index).data); });
    unless_refused([&] { check_mesh(parse_serialized(file_of(input), "input.serialized", 0).data); });
}

}  // namespace gib::fuzz
