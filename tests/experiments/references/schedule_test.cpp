// How many passes the rounds of a reference have.
#include "experiments/references/schedule.h"

#include "experiments/metrics/reference_image.h"

#include <gtest/gtest.h>

#include <tuple>

namespace gib::test::reference_schedule_test {
namespace {

// A third of the work that the pilot foresees, in a power of two of passes; 1e8 rays and samples at most; a third of the time
// that is left.
TEST(ReferenceSchedule, BeginsWithAShareOfTheForeseenWork) {
    const std::vector<MethodShare> shares = {{"a", 2, {}}};
    const ReferenceGoal target{0.01, std::nullopt}, limited{0.01, 11};
    ReferenceState state{.seconds = 2, .pilot_seconds = 2, .pilot_work = 1e6, .unit_work = 1e5, .foreseen_work = 1e7};
    EXPECT_EQ(ReferenceSchedule(target).next_units(state, shares), 32u);
    EXPECT_EQ(ReferenceSchedule(limited).next_units(state, shares), 8u) << "3 s are 15 passes";
    state.foreseen_work = 1e12;
    EXPECT_EQ(ReferenceSchedule(target).next_units(state, shares), 512u);
    state.foreseen_work = 0;
    EXPECT_EQ(ReferenceSchedule(target).next_units(state, shares), 1u);
}

TEST(ReferenceSchedule, FollowsFromErrorAndWorkAlone) {
    const ReferenceGoal goal{0.01, std::nullopt};
    const ReferenceSchedule schedule(goal);
    const std::vector<MethodShare> shares = {{"a", 2, {}}, {"b", 0, {}}, {"c", 1, {}}};
    const ReferenceState state{.rounds = 5, .units = 16, .error = 0.0199, .work = 1e6, .seconds = 3};
    EXPECT_EQ(schedule.next_units(state, shares), 16u) << "at most as many as before";
    const auto batches = schedule.next_batches(state, shares);
    ASSERT_EQ(batches.size(), 2u * reference_groups) << "no batch of a method without a share";
    EXPECT_EQ(batches[1].method, 2u);
    const ReferenceBatch& third = batches[2];
    EXPECT_EQ(std::tuple(third.passes, third.passes_before), std::tuple(32u, 32u));
    EXPECT_EQ(third.number, 5u * reference_groups + 1);
    // 47.4 passes are left: a round of 16 and one of 32.
    EXPECT_EQ(schedule.batches_ahead(state, shares).size(), 2 * batches.size());
    EXPECT_NEAR(schedule.work_left(state, shares), 2.96e6, 1e3);
    ReferenceState long_rounds = state;
    long_rounds.work = 16 * 5e7;
    EXPECT_EQ(schedule.next_units(long_rounds, shares), 2u) << "1e8 rays and samples";
    long_rounds.work *= 100;
    EXPECT_EQ(schedule.next_units(long_rounds, shares), 2u) << "an eighth of what is done";
}

}  // namespace
}  // namespace gib::test::reference_schedule_test
