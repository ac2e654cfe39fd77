// The times of a tuning: how the final runs fit into what is left, times to an error from one run (measured, by the law, or
// never), and the clock, with a time that the test sets.
#include "experiments/tuning/final_plan.h"
#include "experiments/tuning/time_estimate.h"
#include "experiments/tuning/tuning_clock.h"

#include "common/core/files.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/table_fixtures.h"

#include <cmath>
#include <limits>

namespace gib::test::tuning_time_test {
namespace {

/// Seconds of all runs of so many seeds.
double cost(const FinalPlan& plan, const FinalNeeds& needs, int seeds) {
    return static_cast<double>(plan.labels) * seeds * (plan.budget + needs.besides);
}
FinalNeeds needs_of(std::size_t least, double left, double shortest) {
    return {.labels = 10, .least = least, .seeds = 6, .left = left, .besides = 0.5, .shortest = shortest};
}

TEST(FinalPlan, RunsNoLongerThanThreeTimesTheShortest) {
    const FinalPlan plan = plan_finals(needs_of(2, 1000, 2));
    EXPECT_EQ(plan.labels, 10u);
    EXPECT_DOUBLE_EQ(plan.budget, 6);
}

TEST(FinalPlan, LeavesOutTheLeastImportantLabels) {
    const FinalNeeds needs = needs_of(2, 105, 2);
    const FinalPlan plan = plan_finals(needs);
    EXPECT_EQ(plan.labels, 5u) << "105 s are 5 labels with 6 seeds of 3 s and 0.5 s";
    EXPECT_GE(plan.budget, 3);
    EXPECT_LE(cost(plan, needs, 6), 105 + 1e-9);
}

TEST(FinalPlan, KeepsTheLeastWithFewerSeeds) {
    const FinalNeeds needs = needs_of(4, 50, 2);
    const FinalPlan plan = plan_finals(needs);
    EXPECT_EQ(plan.labels, 4u);
    EXPECT_DOUBLE_EQ(plan.budget, 3) << "the seeds that do not fit are cut by the clock";
    EXPECT_LE(cost(plan, needs, 3), 50);
}

TEST(FinalPlan, NeverAsksForMoreThanIsLeft) {
    const FinalNeeds needs = needs_of(4, 50, 100);
    EXPECT_LE(cost(plan_finals(needs), needs, 3), 50 + 1e-9);
    EXPECT_GT(plan_finals(needs_of(4, 0, 100)).budget, 0);
}

TEST(FinalPlan, SharesTheTimeAmongTheLeastIfNothingIsKnown) {
    const FinalNeeds needs = needs_of(4, 60, std::numeric_limits<double>::infinity());
    const FinalPlan plan = plan_finals(needs);
    EXPECT_EQ(plan.labels, 4u);
    EXPECT_NEAR(cost(plan, needs, 6), 60, 1e-9);
}

/// rel_mse = floor + 1 / (seconds - 0.5), after 1, 2, 4, ... passes of 1 s each.
Cell run_with_floor(double floor, int checkpoints) {
    Cell cell;
    cell.prepare_seconds = 0.5;
    std::uint32_t passes = 1;
    for (int i = 0; i < checkpoints; ++i, passes *= 2)
        cell.checkpoints.push_back(checkpoint_of(passes, 0.5 + passes, floor + 1.0 / passes));
    return cell;
}

TEST(TimeEstimate, IsTheCrossingWhereTheTargetWasReached) {
    const TimeEstimate time = estimated_time(run_with_floor(0, 8), 0.25);
    EXPECT_TRUE(time.is_measured);
    EXPECT_NEAR(time.seconds, 16.5, 1e-9);
    EXPECT_EQ(passes_to({run_with_floor(0, 8), run_with_floor(0, 8)}, 0.25), 16u);
    EXPECT_EQ(log_times({run_with_floor(0, 8)}, 0.25).size(), 1u);
    EXPECT_TRUE(log_times({run_with_floor(0, 8), run_with_floor(0, 3)}, 0.25).empty())
        << "one of the runs does not reach it";
}

TEST(TimeEstimate, IsExtrapolatedByTheLaw) {
    // A floor of 0.01 and a target of 0.0225 leave 0.0125, which 1 / (t - 0.5) reaches after 80.5 s.
    const TimeEstimate time = estimated_time(run_with_floor(0.01, 5), 0.15);
    EXPECT_FALSE(time.is_measured);
    EXPECT_NEAR(time.seconds, 80.5, 0.5);
    // Two points have no law: 1 / (t - 0.5) from the last one.
    EXPECT_NEAR(estimated_time(run_with_floor(0, 2), 0.1).seconds, 100.5, 1e-6);
}

TEST(TimeEstimate, IsInfiniteBelowTheFloor) {
    EXPECT_TRUE(std::isinf(estimated_time(run_with_floor(0.01, 6), 0.05).seconds));
    Cell converged = run_with_floor(0, 2);
    converged.converged = true;
    EXPECT_TRUE(std::isinf(estimated_time(converged, 0.01).seconds));
    EXPECT_TRUE(std::isinf(estimated_time(Cell{}, 0.01).seconds));
}

TEST(TimeEstimate, CostsBeyondTheHorizonWhatTheErrorThereSays) {
    // At 100.5 s the squared error is 0.01 above the floor.
    const double horizon = 100.5, target = 0.05;
    for (const double floor : {0.01, 0.005})
        EXPECT_NEAR(estimated_time(run_with_floor(floor, 6), target, horizon).cost(), horizon * (floor + 0.01) / 0.0025,
                    0.01 * horizon)
            << "floor " << floor;
    // Without a floor, the cost goes on where the time ends.
    EXPECT_NEAR(estimated_time(run_with_floor(0, 6), target, horizon).cost(),
                estimated_time(run_with_floor(0, 6), target).seconds, 0.01 * 400);
    const TimeEstimate reachable = estimated_time(run_with_floor(0.01, 5), 0.15, horizon);
    EXPECT_EQ(reachable.cost(), reachable.seconds);
    // An image that is later than the horizon.
    EXPECT_NEAR(estimated_time(run_with_floor(0, 2), 0.1, 1).cost(), 2.5 * 0.5 / 0.01, 1e-6);
}

class TuningClockTest : public ::testing::Test {
protected:
    TuningClock clock() {
        return TuningClock(folder_ / "clock.json", [this] { return now_; });
    }
    /// A round "a" of 3 s that an earlier program ended so.
    void earlier_round(bool complete, bool cut = false) {
        TuningClock c = clock();
        c.begin("a", "content");
        now_ += 3;
        c.end(complete, cut);
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
    earlier_round(true, true);
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
    earlier_round(false);
    TuningClock c = clock();
    c.begin("a", "content");
    EXPECT_FALSE(c.was_done());
    now_ += 7;
    EXPECT_EQ(c.used(), 10);
}

TEST_F(TuningClockTest, OtherContentAndLostResultsBeginAgain) {
    earlier_round(true);
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
}  // namespace gib::test::tuning_time_test
