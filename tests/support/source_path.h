#pragma once
// The paths of the sources that the tests were built from, and of the program.

#include <string>

namespace gib::test {

/// The path of a file or folder of the repository; `name` is relative to the repository's top.
std::string source_path(const std::string& name);

/// The path of the program gibench.
std::string program_path();

}  // namespace gib::test
