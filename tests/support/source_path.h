#pragma once
// Where the sources are that the tests were built from.

#include <string>

namespace gib::test {

/// Of a file or folder of the repository; `name` is relative to its top.
std::string source_path(const std::string& name);

/// Of the program gibench.
std::string program_path();

}  // namespace gib::test
