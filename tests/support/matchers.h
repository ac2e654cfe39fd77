#pragma once
// The names of GoogleMock and of the library that most tests use.

#include <gmock/gmock.h>

#include <filesystem>

namespace gib::test {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

}  // namespace gib::test
