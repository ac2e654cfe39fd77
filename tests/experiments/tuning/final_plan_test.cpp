// Tests of how the final runs of a tuning fit into the time that is left.
#include "experiments/tuning/final_plan.h"

#include <gtest/gtest.h>

#include <limits>

namespace gib::final_plan_test {
namespace {

/// Seconds of all runs of so many seeds.
double cost(const FinalPlan& plan, const FinalNeeds& needs, int seeds) {
    return static_cast<double>(plan.labels) * seeds * (plan.budget + needs.besides);
}

TEST(FinalPlan, RunsNoLongerThanThreeTimesTheShortest) {
    const FinalPlan plan =
        plan_finals({.labels = 10, .least = 2, .seeds = 6, .left = 1000, .besides = 0.5, .shortest = 2});
    EXPECT_EQ(plan.labels, 10u);
    EXPECT_DOUBLE_EQ(plan.budget, 6);
}

TEST(FinalPlan, LeavesOutTheLeastImportantLabels) {
    const FinalNeeds needs{.labels = 10, .least = 2, .seeds = 6, .left = 105, .besides = 0.5, .shortest = 2};
    const FinalPlan plan = plan_finals(needs);
    EXPECT_EQ(plan.labels, 5u) << "105 s are 5 labels with 6 seeds of 3 s and 0.5 s";
    EXPECT_GE(plan.budget, 3);
    EXPECT_LE(cost(plan, needs, 6), 105 + 1e-9);
}

TEST(FinalPlan, KeepsTheLeastWithFewerSeeds) {
    const FinalNeeds needs{.labels = 10, .least = 4, .seeds = 6, .left = 50, .besides = 0.5, .shortest = 2};
    const FinalPlan plan = plan_finals(needs);
    EXPECT_EQ(plan.labels, 4u);
    EXPECT_DOUBLE_EQ(plan.budget, 3) << "the seeds that do not fit are cut by the clock";
    EXPECT_LE(cost(plan, needs, 3), 50);
}

TEST(FinalPlan, NeverAsksForMoreThanIsLeft) {
    const FinalNeeds needs{.labels = 10, .least = 4, .seeds = 6, .left = 50, .besides = 0.5, .shortest = 100};
    EXPECT_LE(cost(plan_finals(needs), needs, 3), 50 + 1e-9);
    const FinalNeeds none{.labels = 10, .least = 4, .seeds = 6, .left = 0, .besides = 0.5, .shortest = 100};
    EXPECT_GT(plan_finals(none).budget, 0);
}

TEST(FinalPlan, SharesTheTimeAmongTheLeastIfNothingIsKnown) {
    const FinalNeeds needs{.labels = 10,
                           .least = 4,
                           .seeds = 6,
                           .left = 60,
                           .besides = 0.5,
                           .shortest = std::numeric_limits<double>::infinity()};
    const FinalPlan plan = plan_finals(needs);
    EXPECT_EQ(plan.labels, 4u);
    EXPECT_NEAR(cost(plan, needs, 6), 60, 1e-9);
}

}  // namespace
}  // namespace gib::final_plan_test
