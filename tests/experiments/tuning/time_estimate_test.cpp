// Times to an error from one run: measured, by the law, never.
#include "experiments/tuning/time_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gib::time_estimate_test {
namespace {

/// rel_mse = floor + 1 / (seconds - 0.5), after 1, 2, 4, ... passes of 1 s each.
Cell cell_of(double floor, int checkpoints) {
    Cell cell;
    cell.prepare_seconds = 0.5;
    std::uint32_t passes = 1;
    for (int i = 0; i < checkpoints; ++i, passes *= 2)
        cell.checkpoints.push_back({{passes, 0.5 + passes, {}, 0}, {{"total", {0, 0, 0, 0, floor + 1.0 / passes}}}});
    return cell;
}

TEST(TimeEstimate, IsTheCrossingWhereTheTargetWasReached) {
    const TimeEstimate time = estimated_time(cell_of(0, 8), 0.25);
    EXPECT_TRUE(time.is_measured);
    EXPECT_NEAR(time.seconds, 16.5, 1e-9);
    EXPECT_EQ(passes_to({cell_of(0, 8), cell_of(0, 8)}, 0.25), 16u);
    EXPECT_EQ(log_times({cell_of(0, 8)}, 0.25).size(), 1u);
    EXPECT_TRUE(log_times({cell_of(0, 8), cell_of(0, 3)}, 0.25).empty()) << "one of the runs does not reach it";
}

TEST(TimeEstimate, IsExtrapolatedByTheLaw) {
    // A floor of 0.01 and a target of 0.0225 leave 0.0125, which 1 / (t - 0.5) reaches after 80.5 s.
    const TimeEstimate time = estimated_time(cell_of(0.01, 5), 0.15);
    EXPECT_FALSE(time.is_measured);
    EXPECT_NEAR(time.seconds, 80.5, 0.5);
    // Two points have no law: 1 / (t - 0.5) from the last one.
    EXPECT_NEAR(estimated_time(cell_of(0, 2), 0.1).seconds, 100.5, 1e-6);
}

TEST(TimeEstimate, IsInfiniteBelowTheFloor) {
    EXPECT_TRUE(std::isinf(estimated_time(cell_of(0.01, 6), 0.05).seconds));
    Cell converged = cell_of(0, 2);
    converged.converged = true;
    EXPECT_TRUE(std::isinf(estimated_time(converged, 0.01).seconds));
    EXPECT_TRUE(std::isinf(estimated_time(Cell{}, 0.01).seconds));
}

TEST(TimeEstimate, CostsBeyondTheHorizonWhatTheErrorThereSays) {
    // At 100.5 s the squared error is 0.01 above the floor.
    const double horizon = 100.5, target = 0.05;
    for (const double floor : {0.01, 0.005})
        EXPECT_NEAR(estimated_time(cell_of(floor, 6), target, horizon).cost(), horizon * (floor + 0.01) / 0.0025,
                    0.01 * horizon)
            << "floor " << floor;
    // Without a floor, the cost goes on where the time ends.
    EXPECT_NEAR(estimated_time(cell_of(0, 6), target, horizon).cost(), estimated_time(cell_of(0, 6), target).seconds,
                0.01 * 400);
    const TimeEstimate reachable = estimated_time(cell_of(0.01, 5), 0.15, horizon);
    EXPECT_EQ(reachable.cost(), reachable.seconds);
    // An image that is later than the horizon.
    EXPECT_NEAR(estimated_time(cell_of(0, 2), 0.1, 1).cost(), 2.5 * 0.5 / 0.01, 1e-6);
}

}  // namespace
}  // namespace gib::time_estimate_test
