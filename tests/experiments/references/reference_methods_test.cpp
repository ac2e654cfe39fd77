// References that several methods make together.

#include "experiments/references/reference_methods.h"

#include "experiments/references/agreement.h"

#include "common/sampling/sampler.h"
#include "experiments/plan/label_checks.h"
#include "tests/support/lit_rooms.h"
#include "tests/support/matchers.h"

namespace gib::test::reference_methods_test {
namespace {

/// The groups of a method: `mean` and uniform noise of this standard deviation in each group, by component. The pixels
/// of the left half are lacking the share `lacking`.
struct Made {
    double direct = 1, direct_noise = 0.1, caustic = 1, caustic_noise = 0.1, lacking = 0;
};
std::vector<ComponentImages> groups_of(const Made& made, std::uint64_t seed) {
    constexpr int size = 32;
    std::vector<ComponentImages> groups(reference_groups);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        groups[g].width = groups[g].height = size;
        for (const auto& [c, mean, noise] : {std::tuple(Component::direct, made.direct, made.direct_noise),
                                             std::tuple(Component::caustic, made.caustic, made.caustic_noise)}) {
            groups[g][c] = Image(size, size);
            for (std::size_t i = 0; i < groups[g][c]->rgb.size(); ++i) {
                const Sampler u(PointSet::independent, seed, i, static_cast<std::uint32_t>(g));
                const double uniform = std::sqrt(12.0) * (double{u.get_1d(static_cast<std::uint32_t>(c))} - 0.5);
                const bool left = i / 3 % size < size / 2;
                groups[g][c]->rgb[i] = static_cast<float>((left ? 1 - made.lacking : 1) * mean + noise * uniform);
            }
        }
    }
    return groups;
}

MethodPilot pilot_of(const Made& made, std::uint64_t seed, double work_of_pass = 1) {
    return {.groups = groups_of(made, seed), .passes = 1, .work = reference_groups * work_of_pass, .unresolved = {}};
}
/// The plan of two methods whose pass takes this work.
ReferencePlan plan_of(const Made& a, const Made& b, double work_of_a = 1, double work_of_b = 1) {
    return plan_of_least_variance({"a", "b"}, {pilot_of(a, 1, work_of_a), pilot_of(b, 2, work_of_b)}, 0.01);
}
double weight(const ReferencePlan& plan, std::size_t method, Component c) {
    return plan.shares[method].weights[static_cast<std::size_t>(index_of(c))];
}

// With variances v of a pass, times t of a pass and n passes, the weights of least variance are in proportion to n / v.
TEST(ReferencePlan, WeighsByPassesAndVariance) {
    const ReferencePlan plan =
        plan_of({.direct_noise = 0.1, .caustic_noise = 0.3}, {.direct_noise = 0.2, .caustic_noise = 0.1}, 1, 2);
    const double passes_a = plan.shares[0].passes, passes_b = plan.shares[1].passes;
    ASSERT_GT(passes_a, 0);
    ASSERT_GT(passes_b, 0);
    ASSERT_NE(passes_a, passes_b);
    const double direct = passes_a / 0.01 / (passes_a / 0.01 + passes_b / 0.04);
    const double caustic = passes_a / 0.09 / (passes_a / 0.09 + passes_b / 0.01);
    EXPECT_NEAR(weight(plan, 0, Component::direct), direct, 0.01);
    EXPECT_NEAR(weight(plan, 0, Component::caustic), caustic, 0.01);
    EXPECT_NEAR(weight(plan, 0, Component::direct) + weight(plan, 1, Component::direct), 1, 1e-12);
}

// One method is better at both components: it gets nine tenths of the work, and the other a tenth as the second opinion. If a pass
// of the better one takes longer, the other gets the nine tenths.
TEST(ReferencePlan, GivesTheWorkToTheCheaperMethodButForASecondOpinion) {
    const Made better{.direct_noise = 0.1, .caustic_noise = 0.1}, worse{.direct_noise = 0.2, .caustic_noise = 0.2};
    const ReferencePlan plan = plan_of(better, worse);
    EXPECT_EQ(plan.shares[0].passes, 9u);
    EXPECT_EQ(plan.shares[1].passes, 1u);
    // Weights by precision were 36 / 37, from 9 / 0.01 and 1 / 0.04; the second opinion makes nothing itself.
    EXPECT_EQ(weight(plan, 0, Component::direct), 1);
    // The predicted squared error of one unit of work: the variances of both components over r^2 + epsilon.
    EXPECT_NEAR(plan.error2_work, 2 * 10 / 900.0 / (4 + 0.01), 0.05 * 0.005);
    EXPECT_EQ(plan.unit_work, 10);
    const ReferencePlan slow = plan_of(better, worse, 100);
    EXPECT_LT(100 * slow.shares[0].passes, slow.shares[1].passes);
}

// Each method is a little better at one component: together they would be 3 % sooner, which is not worth it.
TEST(ReferencePlan, LeavesTheWorkToOneMethodWhereOthersGainLittle) {
    const ReferencePlan plan =
        plan_of({.direct_noise = 0.1, .caustic_noise = 0.12}, {.direct_noise = 0.12, .caustic_noise = 0.1});
    EXPECT_EQ(plan.shares[0].passes + plan.shares[1].passes, 10u);
    EXPECT_EQ(std::max(plan.shares[0].passes, plan.shares[1].passes), 9u);
}

// Another pilot need not try a method that is several times dearer at everything, unless only two are left.
TEST(ReferencePlan, SaysWhichMethodsAreOutdone) {
    const auto outdone = [](const std::vector<Made>& methods) {
        std::vector<std::string> names;
        std::vector<MethodPilot> pilots;
        for (const Made& made : methods) {
            names.push_back(std::to_string(pilots.size()));
            pilots.push_back(pilot_of(made, pilots.size() + 1));
        }
        return plan_of_least_variance(names, pilots, 0.01).outdone;
    };
    const Made good, worse{.direct_noise = 0.2, .caustic_noise = 0.2}, dear{.direct_noise = 0.4, .caustic_noise = 0.4};
    EXPECT_EQ(outdone({good, worse, dear}), (std::vector<bool>{false, false, true}));
    EXPECT_EQ(outdone({dear, good}), (std::vector<bool>{false, false}));
    const Made good_at_one{.direct_noise = 0.4, .caustic_noise = 0.02},
        near{.direct_noise = 0.12, .caustic_noise = 0.12};
    EXPECT_EQ(outdone({good, worse, good_at_one, near}), (std::vector<bool>{false, true, false, false}));
    EXPECT_EQ(outdone({good, worse, near}), (std::vector<bool>{false, true, false}));
}

// The variance of a pass of one method falls with n^-1/2, as that of good points does, and the pilot ends before it is the better
// one. Where a single bright pixel has made the first round noisy, the fall says nothing.
TEST(ReferencePlan, ForeseesTheGainOfPoints) {
    const double fall = std::pow(4, -0.75);  // of the standard deviation, from 1 to 4 passes
    const Made first{.direct_noise = 0.4, .caustic_noise = 0.4};
    const Made last{.direct_noise = 0.4 * fall, .caustic_noise = 0.4 * fall};
    const Made other{.direct_noise = 0.12, .caustic_noise = 0.12};
    const auto share_of_first_method = [&](const std::vector<ComponentImages>& before, double work) {
        std::vector<MethodPilot> pilots = {pilot_of(last, 1), pilot_of(other, 2)};
        for (MethodPilot& pilot : pilots) {
            pilot.passes = 4;
            pilot.work *= 4;
        }
        pilots[0].first_groups = before;
        pilots[0].first_passes = 1;
        const ReferencePlan plan = plan_of_least_variance({"a", "b"}, pilots, 0.01, work);
        return static_cast<double>(plan.shares[0].passes) / (plan.shares[0].passes + plan.shares[1].passes);
    };
    const double much = 64 * 4 * reference_groups;
    EXPECT_EQ(share_of_first_method({}, much), 0.1);
    EXPECT_EQ(share_of_first_method(groups_of(first, 3), much), 0.9);
    EXPECT_EQ(share_of_first_method(groups_of(first, 3), 0), 0.1) << "the reference will have few passes";
    std::vector<ComponentImages> spotted = groups_of(last, 3);
    for (std::size_t g = 0; g < spotted.size(); ++g)
        for (Component c : {Component::direct, Component::caustic})
            for (std::size_t k = 0; k < 3; ++k)
                spotted[g][c]->rgb[300 + k] += g % 2 ? 100.f : -100.f;
    EXPECT_EQ(share_of_first_method(spotted, much), 0.1);
}

// A method without noise that lacks light has not found it yet: beyond doubt, or not.
TEST(ReferencePlan, LeavesAComponentToTheMethodThatLacksNone) {
    const ReferencePlan plan = plan_of({.caustic_noise = 1e-4, .lacking = 0.9}, {.caustic_noise = 0.3});
    EXPECT_EQ(weight(plan, 0, Component::caustic), 0);
    EXPECT_EQ(weight(plan, 1, Component::caustic), 1);
    const ReferencePlan little = plan_of({.caustic_noise = 1e-4, .lacking = 0.07}, {.caustic_noise = 0.3});
    EXPECT_EQ(weight(little, 0, Component::caustic), 0) << "its error would be smaller, but stay";
    const ReferencePlan doubtful = plan_of({.caustic_noise = 1e-4, .lacking = 0.9}, {.caustic_noise = 40});
    EXPECT_GT(weight(doubtful, 0, Component::caustic), 0);
    EXPECT_GT(doubtful.shares[1].passes, 0u) << "whose images go on to be compared";
}

// The lamp in view that only one method finds, and finds without noise, is made by it although the other one is better at the rest.
TEST(ReferencePlan, HasAMethodForEveryComponentThatIsLit) {
    const Made blind{.caustic = 0, .caustic_noise = 0};
    const ReferencePlan plan = plan_of(blind, {.direct_noise = 0.4, .caustic_noise = 0});
    EXPECT_GT(plan.shares[0].passes, plan.shares[1].passes);
    EXPECT_GT(plan.shares[1].passes, 0u);
    EXPECT_EQ(weight(plan, 0, Component::caustic), 0);
    EXPECT_EQ(weight(plan, 1, Component::caustic), 1);
}

TEST(ReferencePlan, LeavesOutWhatAMethodCannotSample) {
    MethodPilot blind = pilot_of({.caustic = 0, .caustic_noise = 0}, 1);
    blind.unresolved = {Component::caustic};
    const ReferencePlan plan = plan_of_least_variance({"blind", "all"}, {blind, pilot_of({}, 2)}, 0.01);
    EXPECT_EQ(weight(plan, 0, Component::caustic), 0);
    EXPECT_EQ(weight(plan, 1, Component::caustic), 1);
}

TEST(MethodShares, AreLeftToOthersWhereOneLacksLight) {
    constexpr Component c = Component::caustic;
    std::vector<MethodShare> shares(3);
    shares[0].weight(c) = 0.5;
    shares[1].weight(c) = 0.3;
    shares[2].weight(c) = 0.2;
    for (std::size_t m = 0; m < 3; ++m)
        shares[m].passes = std::array{8u, 1u, 16u}[m];
    leave_to_others(shares, c, 0, 2);
    EXPECT_EQ(shares[1].passes, 8u);
    EXPECT_EQ(shares[2].passes, 16u);
    EXPECT_EQ(shares[0].weight(c), 0);
    EXPECT_NEAR(shares[1].weight(c), 0.6, 1e-12);
    EXPECT_NEAR(shares[2].weight(c), 0.4, 1e-12);
    leave_to_others(shares, c, 1, 2);
    EXPECT_EQ(shares[2].weight(c), 1);
    // The second opinion, which made nothing, has found more light than all who did.
    leave_to_others(shares, c, 2, 0);
    EXPECT_EQ(shares[0].weight(c), 1);
    EXPECT_EQ(shares[2].weight(c), 0);
}

TEST(ReferencePlan, IsReadFromItsText) {
    const ReferencePlan plan = plan_of({.direct_noise = 0.3}, {.caustic_noise = 0.3});
    const auto read = shares_in(text_of(plan.shares));
    ASSERT_EQ(read.size(), 2u);
    for (std::size_t m = 0; m < 2; ++m) {
        EXPECT_EQ(read[m].method, plan.shares[m].method);
        EXPECT_EQ(read[m].passes, plan.shares[m].passes);
        EXPECT_EQ(read[m].weights, plan.shares[m].weights);
    }
    EXPECT_TRUE(shares_in("a two").empty());
}

TEST(MethodAgreement, SaysWhoDisagreesAboutWhatAndWhere) {
    const auto all = [](std::size_t, Component) { return true; };
    MethodAgreement agree(2), differ(2);
    agree.add(0, groups_of({}, 1), 1);
    agree.add(1, groups_of({.direct_noise = 0.3}, 2), 1);
    EXPECT_TRUE(agree.between_methods(all).empty());
    differ.add(0, groups_of({}, 1), 1);
    differ.add(1, groups_of({.lacking = 0.05}, 2), 1);
    const auto both = differ.between_methods(all);
    ASSERT_EQ(both.size(), 2u) << "direct and caustic light";
    const Disagreement* found = &both.front();
    EXPECT_EQ(found->component, Component::direct);
    EXPECT_EQ(std::pair(found->lesser(), found->greater()), std::pair(std::size_t{1}, std::size_t{0}));
    EXPECT_LE(found->where.x + found->where.width, 32);
    EXPECT_THAT(text_of(found->where), HasSubstr("standard errors"));
    EXPECT_TRUE(differ.between_methods([](std::size_t m, Component) { return m == 0; }).empty()) << "not asked";
}

// One block of 8 x 8 pixels among 16 has a tenth more light.
TEST(MethodAgreement, FindsASmallRegion) {
    MethodAgreement methods(2);
    std::vector<ComponentImages> groups = groups_of({}, 2);
    for (ComponentImages& group : groups)
        for (int y = 8; y < 16; ++y)
            for (int x = 16; x < 24; ++x)
                group[Component::caustic]->set(static_cast<std::size_t>(32 * y + x), Color::Constant(1.1f));
    methods.add(0, groups_of({}, 1), 1);
    methods.add(1, groups, 1);
    const auto all = methods.between_methods([](std::size_t, Component) { return true; });
    ASSERT_EQ(all.size(), 1u);
    const Disagreement* found = &all.front();
    EXPECT_EQ(found->component, Component::caustic);
    EXPECT_EQ((std::array{found->where.x, found->where.y, found->where.width, found->where.height}),
              (std::array{16, 8, 8, 8}));
    EXPECT_EQ(found->lesser(), 0u);
}

// A pilot of 4 groups has seen light that the finished reference lacks.
TEST(MethodAgreement, ComparesThePilotsWithTheReference) {
    MethodAgreement methods(2);
    methods.set_pilot(0, groups_of({}, 1));
    methods.set_pilot(1, groups_of({.direct_noise = 0.3}, 2));
    EXPECT_TRUE(methods.with_pilots(groups_of({}, 3)).empty());
    const auto found = methods.with_pilots(groups_of({.caustic = 0, .caustic_noise = 0}, 3));
    ASSERT_EQ(found.size(), 2u);
    for (const Disagreement& one : found) {
        EXPECT_EQ(one.component, Component::caustic);
        EXPECT_GT(one.where.deviation, 0);
    }
}

// Light of a point through glass, seen through the same glass: bidirectional path tracing leaves it out, and merging makes
// the rest.
TEST(ReferenceMethod, TakesTheRemainder) {
    const auto scene = room({.light = lit_rooms::point, .glossy_wall = "", .ball = lit_rooms::glass_ball});
    const MethodDescription& description = find_method("bidirectional");
    const ReferenceMethod alone(description, {"bidirectional", {}}, scene, false),
        both(description, {"auto", {}}, scene, true);
    EXPECT_FALSE(alone.unresolved().empty());
    EXPECT_TRUE(both.unresolved().empty());
    EXPECT_EQ(both.name(), "bidirectional+vcm");
    EXPECT_EQ(ReferenceMethod(find_method("path"), {"auto", {}}, scene, true).name(), "path");
    const auto make = [&](const ReferenceMethod& method, std::uint64_t passes_before) {
        return method.make(7, 256, passes_before, [] {}).images;
    };
    const ComponentImages part = make(alone, 0), whole = make(both, 0), later = make(both, 1000000);
    EXPECT_GT(mean_of(*whole[Component::caustic]).sum(), 1.02 * mean_of(*part[Component::caustic]).sum());
    EXPECT_EQ(whole[Component::direct]->rgb, part[Component::direct]->rgb);
    ASSERT_TRUE(whole.bias[static_cast<std::size_t>(index_of(Component::caustic))]);
    // It goes on where others have stopped, with a smaller radius.
    EXPECT_NE(later[Component::caustic]->rgb, whole[Component::caustic]->rgb);
    // Nothing remains under a lamp.
    const auto lit = room({.light = lit_rooms::lamp, .ball = lit_rooms::glass_ball});
    EXPECT_FALSE(ReferenceMethod(description, {"auto", {}}, lit, true).makes_remainder());
}

}  // namespace
}  // namespace gib::test::reference_methods_test
