// The clock of a tuning, with a time that the test sets.
#include "experiments/tuning/tuning_clock.h"

#include "common/core/files.h"
#include "tests/support/driver_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::tuning_clock_test {
namespace {

class TuningClockTest : public ::testing::Test {
protected:
    TuningClock clock() {
        return TuningClock(folder_ / "clock.json", [this] { return now_; });
    }
    TemporaryFolder folder_;
    double now_ = 1000;
};

TEST_F(TuningClockTest, CountsRoundsAndNothingBetweenThem) {
    TuningClock c = clock();
    EXPECT_EQ(c.used(), 0);
    c.begin("a", "content");
    now_ += 3;
    EXPECT_EQ(c.used(), 3);
    c.end(true);
    now_ += 100;
    EXPECT_EQ(c.used(), 3);
    c.begin("b", "content");
    now_ += 2;
    EXPECT_EQ(c.used(), 5);
}

TEST_F(TuningClockTest, ARoundThatWasDoneCountsAsItDidThen) {
    {
        TuningClock c = clock();
        c.begin("a", "content");
        now_ += 3;
        c.end(true, true);
    }
    TuningClock c = clock();
    c.begin("a", "content");
    EXPECT_TRUE(c.was_done());
    EXPECT_TRUE(c.was_cut());
    now_ += 7;
    EXPECT_EQ(c.used(), 3);
    c.end(true);
    EXPECT_EQ(c.used(), 3);
}

TEST_F(TuningClockTest, AnInterruptedRoundGoesOn) {
    {
        TuningClock c = clock();
        c.begin("a", "content");
        now_ += 3;
        c.end(false);
    }
    TuningClock c = clock();
    c.begin("a", "content");
    EXPECT_FALSE(c.was_done());
    now_ += 7;
    EXPECT_EQ(c.used(), 10);
}

TEST_F(TuningClockTest, OtherContentAndLostResultsBeginAgain) {
    {
        TuningClock c = clock();
        c.begin("a", "content");
        now_ += 3;
        c.end(true);
    }
    TuningClock other = clock();
    other.begin("a", "other content");
    EXPECT_FALSE(other.was_done());
    EXPECT_EQ(other.used(), 0);
    TuningClock lost = clock();
    lost.begin("a", "content", false);
    EXPECT_EQ(lost.used(), 0);
    write_file(folder_ / "clock.json", "{\"a\": 3}");
    TuningClock damaged = clock();
    damaged.begin("a", "content");
    EXPECT_EQ(damaged.used(), 0);
}

}  // namespace
}  // namespace gib::test::tuning_clock_test
