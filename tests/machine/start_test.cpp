// Tests of the start: the libraries that the program loads before it does anything.
#include "common/core/files.h"
#include "tests/support/scene_text.h"
#include "tests/support/source_path.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace gib::start_test {
namespace {

// OpenImageIO's libraries take 25 MiB and, on a slow machine, 0.1 s to initialise their tables of strings.
TEST(ProgramStart, LoadsNoLibraryOfImages) {
    const test::TemporaryFolder folder;
    const std::string command =
        "LD_TRACE_LOADED_OBJECTS=1 '" + test::program_path() + "' >'" + (folder / "libraries") + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const std::string libraries = read_file(folder / "libraries");
    EXPECT_NE(libraries.find("libembree"), std::string::npos) << libraries;
    EXPECT_EQ(libraries.find("OpenImageIO"), std::string::npos) << libraries;
}

}  // namespace
}  // namespace gib::start_test
