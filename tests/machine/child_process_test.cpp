// The whole output of a child process reaches its parent.

#include "experiments/system/child_process.h"

#include "common/core/error.h"
#include "tests/support/matchers.h"
#include "tests/support/scene_text.h"
#include "tests/support/source_path.h"

#include <unistd.h>

#include <cstdlib>
#include <vector>

namespace gib::test::child_process_test {
namespace {

/// The lines that a shell script prints. The parent is busy with the first line for `first_takes` [us].
std::vector<std::string> lines_of(const std::string& script, unsigned first_takes = 0) {
    std::vector<std::string> lines;
    run_child({"/bin/sh", "-c", script}, [&](const std::string& line) {
        if (lines.empty()) usleep(first_takes);
        lines.push_back(line);
    });
    return lines;
}

// A pipe holds 64 KiB, so the child ends while most of its last line is still in the pipe.
TEST(ChildProcess, LastWordsAreReadAfterItsEnd) {
    const auto lines = lines_of("echo first; head -c 60000 /dev/zero | tr '\\0' x; echo", 300'000);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0], "first");
    EXPECT_EQ(lines[1].size(), 60000u);
}

}  // namespace
}  // namespace gib::test::child_process_test
