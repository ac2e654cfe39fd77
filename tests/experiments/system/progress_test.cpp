// Lines of progress where stderr is no terminal.

#include "experiments/system/progress.h"

#include <gtest/gtest.h>

namespace gib::test::progress_test {
namespace {

TEST(Progress, InAFileNoLineIsRepeated) {
    testing::internal::CaptureStderr();
    {
        ProgressLine line(false, 0.0);
        for (const double fraction : {0.1, 0.84, 0.84, 0.841, 0.85})
            line.update(fraction, 198, "room");
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              " 10 %, 3 min 18 s left  room\n 84 %, 3 min 18 s left  room\n 85 %, 3 min 18 s left  room\n");
}

}  // namespace
}  // namespace gib::test::progress_test
