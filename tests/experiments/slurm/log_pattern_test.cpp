// Paths in the patterns of sbatch.

#include "experiments/slurm/slurm_client.h"
#include "tests/support/input_error.h"

#include <gmock/gmock.h>

namespace gib::test::log_pattern_test {
namespace {

TEST(LogPattern, APercentSignInAPathIsNoReplacementSymbol) {
    EXPECT_EQ(log_pattern("/data/results"), "/data/results");
    EXPECT_EQ(log_pattern("/data/50%a/%j/100%"), "/data/50%%a/%%j/100%%");
}

TEST(LogPattern, ABackslashWouldSwitchReplacementOff) {
    EXPECT_THAT(input_error_of([] { log_pattern("/data/a\\b"); }), ::testing::HasSubstr("a path with a backslash"));
}

}  // namespace
}  // namespace gib::test::log_pattern_test
