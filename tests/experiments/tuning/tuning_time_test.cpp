// The times of a tuning: to an error from one run, the verdict of several runs (measured, extrapolated, not reachable).
#include "experiments/tuning/time_estimate.h"

#include "tests/support/matchers.h"
#include "tests/support/table_fixtures.h"

#include <cmath>
#include <limits>
#include <random>

namespace gib::test::tuning_time_test {
namespace {

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

/// A run in which the squared error is (floor + 1 / passes) f, after 1, 2, 4, ... passes of `pace` seconds.
Cell run_at(double pace, double floor, int checkpoints, double f = 1) {
    Cell cell;
    std::uint32_t passes = 1;
    for (int i = 0; i < checkpoints; ++i, passes *= 2)
        cell.checkpoints.push_back(checkpoint_of(passes, pace * passes, (floor + 1.0 / passes) * f));
    return cell;
}

TEST(Verdict, IsMeasuredWhereEveryRunHasReachedTheTarget) {
    const Verdict v = verdict_of({run_at(1, 0, 8), run_at(1.1, 0, 8)}, 0.25, false);
    EXPECT_EQ(v.state, Verdict::measured);
    EXPECT_NEAR(v.seconds.value, 16 * std::sqrt(1.1), 1e-9);
    EXPECT_EQ(v.passes, 16u);
    EXPECT_EQ(v.log_times.size(), 2u);
    ASSERT_TRUE(v.seconds.interval);
    EXPECT_LT(v.seconds.interval->lo, v.seconds.value);
    EXPECT_NEAR(v.error, 1 / std::sqrt(128), 1e-9);
    const Verdict one = verdict_of({run_at(1, 0, 8)}, 0.25, false);
    EXPECT_EQ(one.state, Verdict::measured) << "one run is enough to have reached it";
    EXPECT_FALSE(one.seconds.interval);
}

TEST(Verdict, IsExtrapolatedWhereARunHasNot) {
    const std::vector<Cell> runs = {run_at(1, 0, 8), run_at(1, 0, 3), run_at(1, 0, 4)};
    const Verdict v = verdict_of(runs, 0.25, true);
    EXPECT_EQ(v.state, Verdict::extrapolated);
    EXPECT_NEAR(v.seconds.value, 16, 1e-6) << "all runs have the same law";
    EXPECT_EQ(v.passes, 16u);
    EXPECT_EQ(v.reached, 1u);
}

TEST(Verdict, IsNotReachableBelowAFloorThatTheRunsShow) {
    std::vector<Cell> runs;
    for (const double f : {0.98, 0.99, 1.0, 1.01, 1.02})
        runs.push_back(run_at(1, 0.0256, 8, f));
    const Verdict v = verdict_of(runs, 0.02, false);
    ASSERT_EQ(v.state, Verdict::not_reachable);
    EXPECT_NEAR(v.floor.value, 0.16, 0.01);
    ASSERT_TRUE(v.floor.interval);
    EXPECT_LT(v.floor.interval->lo, v.floor.value);
    EXPECT_GT(v.floor.interval->hi, v.floor.value);
    EXPECT_EQ(verdict_of(runs, 0.2, false).state, Verdict::measured) << "the floor lies below";
}

// No run has reached the target after 4 s, whatever their law says; one run has no scatter.
TEST(Verdict, ExtrapolatedIntervalsBeginWhereTheRunsEnd) {
    for (const auto& runs : {std::vector{run_at(1, 0, 3)}, {run_at(1, 0, 3), run_at(1, 0, 3, 4)}}) {
        const Verdict v = verdict_of(runs, 0.1, true);
        ASSERT_EQ(v.state, Verdict::extrapolated);
        ASSERT_TRUE(v.seconds.interval);
        EXPECT_GE(v.seconds.interval->lo, 4);
        EXPECT_TRUE(std::isinf(v.seconds.interval->hi));
    }
}

// Rare bright paths raise the errors at the end, after 64 s. The laws of the other points say less than the runs have shown.
TEST(Verdict, LiesBeyondARunThatARarePathHasRaised) {
    std::vector<Cell> runs;
    for (const double f : {0.9, 1.0, 1.1}) {
        runs.push_back(run_at(1, 0, 6, f));
        runs.back().checkpoints.push_back(checkpoint_of(64, 64, 0.36 * f));
    }
    for (const double target : {0.5, 0.2}) {
        const Verdict v = verdict_of(runs, target, true);
        ASSERT_EQ(v.state, Verdict::extrapolated);
        EXPECT_GE(v.seconds.value, 64) << target;
        EXPECT_GE(v.seconds.interval->lo, 64) << target;
        EXPECT_TRUE(std::isinf(v.seconds.interval->hi)) << target;
    }
}

TEST(Verdict, OfConvergedRunsIsTheirError) {
    std::vector<Cell> runs = {run_at(1, 0.01, 2), run_at(1, 0.01, 2, 1.1)};
    for (Cell& run : runs)
        run.converged = true;
    EXPECT_EQ(verdict_of(runs, 0.1, false).state, Verdict::not_reachable);
    EXPECT_NEAR(verdict_of(runs, 0.1, false).floor.value, std::sqrt(0.51) * (1 + std::sqrt(1.1)) / 2, 1e-9);
}

// A short run of a method that may be biased shows no floor, whatever it is: there is no upper end.
TEST(Verdict, OfAFewPointsOfAMethodWithBiasHasNoUpperEnd) {
    const Verdict v = verdict_of({run_at(1, 0.0256, 3), run_at(1, 0.0256, 3)}, 0.02, false);
    ASSERT_EQ(v.state, Verdict::extrapolated);
    ASSERT_TRUE(v.seconds.interval);
    EXPECT_TRUE(std::isinf(v.seconds.interval->hi));
    const std::vector<Cell> unbiased = {run_at(1, 0, 3), run_at(1, 0, 3, 1.2)};
    EXPECT_TRUE(std::isfinite(verdict_of(unbiased, 0.1, true).seconds.interval->hi)) << "the floor is known to be 0";
    const Verdict far = verdict_of(unbiased, 0.02, true);
    EXPECT_TRUE(std::isinf(far.seconds.interval->hi)) << "2500 s by runs of 4 s";
    EXPECT_EQ(far.seconds.interval->lo, 400);
}

// An error that does not fall gives no time, not even a lower bound.
TEST(Verdict, OfAMethodWithBiasWhoseErrorStandsIsAsLongAsItsRuns) {
    std::vector<Cell> runs = {run_at(1, 0.15, 6), run_at(1, 0.15, 6, 1.1)};
    for (Cell& run : runs)
        for (CellCheckpoint& checkpoint : run.checkpoints)
            checkpoint.errors = run.checkpoints.back().errors;
    const Verdict v = verdict_of(runs, 0.1, false);
    ASSERT_EQ(v.state, Verdict::extrapolated);
    EXPECT_EQ(v.seconds.interval->lo, runs[0].last().seconds);
    EXPECT_TRUE(std::isinf(v.seconds.interval->hi));
}

// 200 experiments with runs of 5 seeds, whose errors scatter by 10 %, and which end at twice the target.
TEST(Verdict, ExtrapolatedIntervalsHoldTheTruth) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, 0.1);
    int held = 0;
    for (int experiment = 0; experiment < 200; ++experiment) {
        std::vector<Cell> runs;
        for (int seed = 0; seed < 5; ++seed)
            runs.push_back(run_at(1, 0, 7, std::exp(noise(random))));
        const Verdict v = verdict_of(runs, 1 / 16.0, true);  // after 256 passes of 1 s
        if (v.state != Verdict::extrapolated) continue;
        held += v.seconds.interval->lo <= 256 && v.seconds.interval->hi >= 256;
    }
    EXPECT_GE(held, 180) << "of 200, with a coverage of 95 %";
}

}  // namespace
}  // namespace gib::test::tuning_time_test
