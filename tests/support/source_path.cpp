#include "tests/support/source_path.h"

namespace gib::test {

std::string source_path(const std::string& name) { return std::string(GIB_SOURCE_DIR) + "/" + name; }

std::string program_path() { return GIB_PROGRAM; }

}  // namespace gib::test
