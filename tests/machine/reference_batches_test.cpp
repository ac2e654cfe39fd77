// Batches of a reference that other processes make: the reference is the same whoever made them, and its standard error
// falls with their number as theory says.

#include "experiments/measuring/reference.h"
#include "experiments/measuring/reference_schedule.h"
#include "experiments/run/run_plan.h"

#include "common/images/image_digest.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/reference_methods.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/source_path.h"

#include <gmock/gmock.h>

#include <fstream>
#include <limits>

namespace gib::test::reference_batches_test {
namespace {

/// A pass takes so many milliseconds.
template <int pass_milliseconds = 0>
MethodDescription fake_method() {
    return {
        "fake",
        "noise",
        {},
        Effects::all(),
        {Component::direct},
        true,
        [](const ParameterValues&, const MethodDefaults&) -> std::unique_ptr<Method> {
            return std::make_unique<FakeMethod>(FakeBehaviour{.noise = 0.5, .pass_seconds = 0.001 * pass_milliseconds});
        }};
}

class ReferenceBatchesTest : public ::testing::Test {
protected:
    FinishedReference make(const std::string& file, std::optional<double> most_own_work = std::nullopt,
                           std::optional<double> seconds = std::nullopt) {
        ProgressLine progress(false);
        return make_reference(work(file, most_own_work, seconds), progress);
    }
    ReferenceWork work(const std::string& file, std::optional<double> most_own_work = std::nullopt,
                       std::optional<double> seconds = std::nullopt) {
        return {.scene = scene_,
                .methods = {&method_},
                .label = {"fake", {}},
                .goal = {0.02, seconds},
                .epsilon = 0.01,
                .path = folder_ / file,
                .most_own_work = most_own_work};
    }
    /// A reference all of whose batches are made by others. Counts the submissions.
    FinishedReference make_by_others(const std::string& file, int& submissions) {
        for (submissions = 0;; ++submissions) {
            FinishedReference r = make(file, 0);
            if (r.missing.empty()) return r;
            for (const ReferenceBatch& batch : r.missing)
                make_batch(work(file), batch);
        }
    }
    static std::string content_of(const FinishedReference& r) {
        return image_digest(layers_of(r.reference, true)) + r.reference.metadata.at("passes") +
               r.reference.metadata.at("work");
    }
    std::string batch_file(const std::string& file) {
        return std::filesystem::directory_iterator(folder_ / (file + ".batches"))->path().string();
    }

    TemporaryFolder folder_;
    LoadedScene scene_ = scene_of(tiny_scene_xml());
    MethodDescription method_ = fake_method();
};

TEST_F(ReferenceBatchesTest, MakeTheSameReferenceWhoeverMadeThem) {
    const FinishedReference alone = make("alone.exr");
    int submissions = 0;
    const FinishedReference shared = make_by_others("shared.exr", submissions);
    EXPECT_EQ(content_of(shared), content_of(alone));
    EXPECT_EQ(shared.identity, alone.identity);
    EXPECT_GE(submissions, 2);
    EXPECT_LE(submissions, 6) << "rounds are foreseen";
    EXPECT_FALSE(std::filesystem::exists(folder_ / "shared.exr.batches")) << "they are in the reference";
}

TEST_F(ReferenceBatchesTest, DependOnNoTime) {
    const std::string quick = content_of(make("quick.exr"));
    EXPECT_EQ(content_of(make("limit.exr", std::nullopt, 1000)), quick) << "a limit out of sight";
    method_ = fake_method<2>();
    EXPECT_EQ(content_of(make("slow.exr")), quick);
}

TEST_F(ReferenceBatchesTest, ADamagedOneIsMadeAgain) {
    const std::string good = content_of(make("good.exr"));
    const FinishedReference first = make("damaged.exr", 0);
    ASSERT_FALSE(first.missing.empty());
    for (const ReferenceBatch& batch : first.missing)
        make_batch(work("damaged.exr"), batch);
    const std::string file = batch_file("damaged.exr");
    const std::string content = read_file(file);
    std::ofstream(file, std::ios::binary) << content.substr(0, content.size() - 20);
    EXPECT_EQ(content_of(make("damaged.exr")), good);
}

TEST_F(ReferenceBatchesTest, AnEditedOneIsMadeAgain) {
    const std::string good = content_of(make("good.exr"));
    const ReferenceBatch batch = make("edited.exr", 0).missing.at(0);
    make_batch(work("edited.exr"), batch);
    const std::string file = batch_file("edited.exr");
    LayeredImage edited = read_image(file);
    edited.metadata.erase("compression");  // which OpenImageIO adds and OpenEXR does not take as text
    for (auto& [name, layer] : edited.layers)
        for (float& value : layer.rgb)
            value *= 1.01f;
    write_exr(file, edited);
    EXPECT_EQ(content_of(make("edited.exr")), good);
}

TEST_F(ReferenceBatchesTest, TakesBatchesOfOthers) {
    const FinishedReference first = make("others.exr", 0);
    for (const ReferenceBatch& batch : first.missing)
        make_batch(work("others.exr"), batch);
    method_ = fake_method<5000>();  // it would take 40 s for each group
    const FinishedReference second = make("others.exr", 0);
    EXPECT_EQ(second.rounds_added, 4u) << "of 1, 1, 2 and 4 passes";
}

TEST_F(ReferenceBatchesTest, WhatIsShortIsDoneByTheProcessItself) {
    const FinishedReference all = make("all.exr", std::numeric_limits<double>::max());
    EXPECT_FALSE(all.missing.empty()) << "nothing is known before the first round";
    for (const ReferenceBatch& batch : all.missing)
        make_batch(work("all.exr"), batch);
    EXPECT_TRUE(make("all.exr", std::numeric_limits<double>::max()).missing.empty());
}

// The standard errors of n and of 4 n rounds of equal batches, each estimated from 16 groups on 64 pixels: the ratio of
// the variances is 4 times an F variable of 960 and 960 degrees of freedom, and lies within 4 exp(+-0.212) with a
// probability of 99.9 %.
TEST_F(ReferenceBatchesTest, FourTimesAsManyHalveTheStandardError) {
    constexpr std::uint32_t rounds = 4, passes = 4;
    const BatchFolder batches(folder_ / "n.exr.batches");
    const auto error_of = [&](std::uint32_t first, std::uint32_t count) {
        ReferenceGroups groups;
        for (std::uint32_t round = first; round < first + count; ++round) {
            std::vector<ComponentImages> images;
            for (std::uint32_t g = 0; g < reference_groups; ++g) {
                const ReferenceBatch batch{0, round * reference_groups + g, passes, round * passes};
                make_batch(work("n.exr"), batch);
                images.push_back(batches.read(batch).value().images);
            }
            groups.add_round(images, passes);
        }
        return relative_standard_error(groups.reference().total, 0.01);
    };
    const double few = error_of(0, rounds), many = error_of(rounds, 4 * rounds);
    EXPECT_NEAR(2 * std::log(few / many), std::log(4), 0.212);
}

// Several makers share the work of a unit, so that few units are enough, which only their shares tell.
TEST(StoredReference, OfSeveralMakersIsNotToppedUpWithoutNeed) {
    const TemporaryFolder folder;
    const LoadedScene scene = load_scene(source_path("scenes/cornell-box.xml"), {{}, {{24, 24}}, {}});
    const ReferenceWork work{.scene = scene,
                             .methods = reference_methods({"auto", {}}),
                             .label = {"auto", {}},
                             .goal = {0.3, std::nullopt},
                             .epsilon = 0.01,
                             .path = folder / "reference.exr"};
    ProgressLine progress(false);
    const FinishedReference first = make_reference(work, progress);
    ASSERT_LT(std::stoul(first.reference.metadata.at("passes")), 8u);
    EXPECT_EQ(make_reference(work, progress).rounds_added, 0u);
}

TEST(ReferenceSchedule, FollowsFromErrorAndWorkAlone) {
    const ReferenceGoal goal{0.01, std::nullopt};
    const ReferenceSchedule schedule(goal);
    const std::vector<MakerShare> shares = {{"a", 2, {}}, {"b", 0, {}}, {"c", 1, {}}};
    const ReferenceState state{.rounds = 5, .passes = 16, .error = 0.0199, .work = 1e6, .seconds = 3};
    EXPECT_EQ(schedule.next_passes(state, shares), 16u) << "at most as many as before";
    const auto batches = schedule.next_batches(state, shares);
    ASSERT_EQ(batches.size(), 2u * reference_groups) << "no batch of a maker without a share";
    EXPECT_EQ(batches[1].maker, 2u);
    EXPECT_EQ(batches[2].passes, 32u);
    EXPECT_EQ(batches[2].passes_before, 32u);
    EXPECT_EQ(batches[2].number, 5u * reference_groups + 1);
    // 47.4 passes are left: a round of 16 and one of 32.
    EXPECT_EQ(schedule.batches_ahead(state, shares).size(), 2 * batches.size());
    EXPECT_NEAR(schedule.work_left(state, shares), 2.96e6, 1e3);
    ReferenceState long_rounds = state;
    long_rounds.work = 16 * 5e7;
    EXPECT_EQ(schedule.next_passes(long_rounds, shares), 2u) << "1e8 rays and samples";
    long_rounds.work *= 100;
    EXPECT_EQ(schedule.next_passes(long_rounds, shares), 2u) << "an eighth of what is done";
}

TEST(SharedOut, PartsAreEvenAndKeepTheOrder) {
    const std::vector<int> things = {0, 1, 2, 3, 4, 5, 6};
    const auto parts = shared_out(things, 3);
    EXPECT_THAT(parts, ::testing::ElementsAre(::testing::ElementsAre(0, 1), ::testing::ElementsAre(2, 3),
                                              ::testing::ElementsAre(4, 5, 6)));
    EXPECT_EQ(shared_out(things, 100).size(), things.size());
    EXPECT_TRUE(shared_out(std::vector<int>(), 3).empty());
}

}  // namespace
}  // namespace gib::test::reference_batches_test
