// The measuring loop: which work it charges, after which passes it takes images, and when it stops.

#include "experiments/measuring/measure.h"

#include "tests/support/driver_fixtures.h"

namespace gib::test::measure_test {
namespace {

class MeasureTest : public ::testing::Test {
protected:
    Measurement run(const FakeBehaviour& behaviour, std::uint32_t spp, const Budget& budget = {},
                    std::uint64_t seed = 1) {
        const FakeMethod method(behaviour);
        return measure({*scene_.scene, method, seed, spp, budget},
                       [&](const Checkpoint& c, const ComponentImages&) { seen_.push_back(c.passes); });
    }
    LoadedScene scene_ = scene_of(tiny_scene_xml());
    std::vector<std::uint32_t> seen_;
};

TEST_F(MeasureTest, ChargesStartAndPassesButNotImages) {
    const Measurement m = run({.start_seconds = 0.05, .pass_seconds = 0.01, .image_seconds = 0.3}, 4);
    EXPECT_GE(m.prepare_seconds, 0.05);
    EXPECT_GE(m.checkpoints.back().seconds, 0.09);
    EXPECT_LT(m.checkpoints.back().seconds, 0.8) << "four images of 0.3 s each are not charged";
}

TEST_F(MeasureTest, CheckpointsAreLogSpacedAndEndWithTheLastPass) {
    run({}, 50);
    EXPECT_THAT(seen_, ElementsAre(1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 50));
}

TEST_F(MeasureTest, TheLastImageMayBeTheOnlyOne) {
    const FakeMethod method({});
    const auto see = [&](const Checkpoint& c, const ComponentImages&) { seen_.push_back(c.passes); };
    measure({.scene = *scene_.scene, .method = method, .seed = 1, .spp = 50, .budget = {}, .only_last = true}, see);
    EXPECT_THAT(seen_, ElementsAre(50));
}

TEST_F(MeasureTest, CheckpointsAreTheSameInEveryReplicate) {
    run({}, 20);
    const auto first = seen_;
    seen_.clear();
    run({.pass_seconds = 0.002}, 20, {}, 2);
    EXPECT_EQ(seen_, first);
}

TEST_F(MeasureTest, BudgetOfPassesEndsBeforeSpp) {
    EXPECT_EQ(run({}, 100, {std::nullopt, 5u}).checkpoints.back().passes, 5u);
    EXPECT_EQ(run({}, 3, {std::nullopt, 5u}).checkpoints.back().passes, 3u);
}

TEST_F(MeasureTest, OnePassCompletesWhateverTheBudget) {
    const Measurement m = run({.pass_seconds = 0.02}, 100, {1e-6, std::nullopt});
    EXPECT_EQ(m.checkpoints.back().passes, 1u);
}

TEST_F(MeasureTest, BudgetOfSecondsStopsAndTheLastPassIsACheckpoint) {
    const Measurement m = run({.pass_seconds = 0.02}, 1000, {0.5, std::nullopt});
    EXPECT_GE(m.checkpoints.back().seconds, 0.5);
    EXPECT_LE(m.checkpoints.back().passes, 25u);
    EXPECT_GE(m.checkpoints.back().passes, 2u);
}

TEST_F(MeasureTest, ConvergenceEndsTheRun) {
    const Measurement m = run({.converges_after = 7}, 100);
    EXPECT_TRUE(m.converged);
    EXPECT_EQ(m.checkpoints.back().passes, 7u);
}

TEST_F(MeasureTest, WhatIsNotStagedIsOther) {
    const Measurement m = run({.start_seconds = 0.05, .staged_seconds = 0.01}, 3);
    ASSERT_EQ(m.stages.size(), 2u);
    EXPECT_EQ(m.stages[0].name, "staged");
    EXPECT_EQ(m.stages[1].name, "other");
    EXPECT_GE(m.stages[1].seconds, 0.05);
    EXPECT_NEAR(m.stages[0].seconds + m.stages[1].seconds, m.checkpoints.back().seconds, 1e-9);
}

TEST_F(MeasureTest, PeakMemoryIsKnown) { EXPECT_GT(run({}, 1).checkpoints.back().peak_rss_mib, 1.0); }

TEST(LastPass, IsTheLabelsElseTheScenesElse16) {
    const auto& method = find_method("path");
    const auto values = [&](const char* label) {
        return ParameterValues(all_parameters(method), MethodLabel::parse(label));
    };
    EXPECT_EQ(last_pass(values("path spp=1e3"), 64), 1000u);
    EXPECT_EQ(last_pass(values("path"), 64), 64u);
    EXPECT_EQ(last_pass(values("path"), std::nullopt), 16u);
}

}  // namespace
}  // namespace gib::test::measure_test
