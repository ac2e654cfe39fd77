// Vertex connection and merging: every set of techniques has the mean of the method that it is, and what merging alone
// makes is what bidirectional path tracing lacks.

#include "tests/support/lit_rooms.h"
#include "tests/support/same_means.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

namespace gib::vcm_test {
namespace {

using namespace test::lit_rooms;
using test::expect_same_means;
using test::room;

// The radii are given, because a pass of these small images has so few light paths that those found make biases of 3 to
// 5 %; that of media falls as r at the edge of the fog, so that its estimate is too small there.
const std::vector<std::string> subsets = {"path",
                                          "vcm techniques=path_tracing",
                                          "vcm techniques=bidirectional",
                                          "vcm techniques=light_tracing",
                                          "vcm radius=0.05 volume_radius=0.05",
                                          "vcm techniques=photon_mapping radius=0.05 volume_radius=0.05"};

TEST(VcmSubsets, AgreeUnderLamps) { expect_same_means(room({.light = lamp}), subsets); }
TEST(VcmSubsets, AgreeUnderDeltaLights) {
    for (const auto& light : {point, sun})
        expect_same_means(room({.light = light, .ball = "<bsdf type='diffuse'/>"}), subsets);
}
TEST(VcmSubsets, AgreeUnderTheSky) { expect_same_means(room({.light = sky + lamp}), subsets); }
TEST(VcmSubsets, AgreeInFog) { expect_same_means(room({.light = lamp, .more = fog}), subsets); }
TEST(VcmSubsets, AgreeBehindAMask) { expect_same_means(room({.light = lamp, .more = grate}), subsets); }
TEST(VcmSubsets, AgreeOnMixedAndSpecularSurfaces) {
    for (const auto& ball : {plastic_ball, glass_ball})
        expect_same_means(room({.light = lamp, .ball = ball}),
                          {"path", "vcm techniques=path_tracing", "vcm techniques=bidirectional", "vcm",
                           "vcm techniques=photon_mapping"});
}
TEST(VcmSubsets, AgreeInFogWithGlass) {
    expect_same_means(room({.light = lamp, .more = fog, .glossy_wall = "", .ball = glass_ball}),
                      {"path", "vcm", "vcm techniques=photon_mapping"});
}

TEST(VcmPlan, OfBidirectionalIsThatMethod) {
    const auto scene = room({.light = lamp, .ball = glass_ball});
    EXPECT_EQ(test::render(scene, "vcm techniques=bidirectional", 4).total().rgb,
              test::render(scene, "bidirectional", 4).total().rgb);
}

/// The mean of each component over seeds of several methods' images together.
std::map<Component, test::Moments> sums_of(const LoadedScene& scene, const std::vector<std::string>& labels) {
    std::map<Component, test::Moments> sums;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        std::map<Component, double> sum;
        for (const std::string& label : labels) {
            const ComponentImages image = test::render(scene, label, 256, seed);
            for (Component c : all_components)
                if (image[c]) sum[c] += test::mean_of(*image[c]).sum();
        }
        for (const auto& [c, value] : sum)
            sums[c].add(value);
    }
    return sums;
}

const std::string inner_point = "<emitter type='point'><point name='position' x='0.7' y='0.8' z='-0.6'/></emitter>";

// A caustic of a point light, seen directly and through the glass that makes it, with fog and without.
TEST(VcmRemainder, IsWhatBidirectionalPathTracingLacks) {
    for (const std::string& more : {std::string(), fog}) {
        const auto scene = room({.light = inner_point, .more = more, .glossy_wall = "", .ball = glass_ball});
        const auto both = sums_of(scene, {"bidirectional", "vcm techniques=remainder"});
        const auto bidirectional = sums_of(scene, {"bidirectional"}),
                   remainder = sums_of(scene, {"vcm techniques=remainder"});
        for (const auto& [c, all] : sums_of(scene, {"vcm"}))
            EXPECT_NEAR(both.at(c).mean(), all.mean(),
                        5.2 * std::hypot(both.at(c).standard_error(), all.standard_error()) + 0.005 * all.mean())
                << name_of(c);
        const Component c = more.empty() ? Component::caustic : Component::volume;
        EXPECT_GT(remainder.at(c).mean(), 5 * remainder.at(c).standard_error());
        EXPECT_LT(bidirectional.at(c).mean(), both.at(c).mean());
        EXPECT_EQ(remainder.at(Component::direct).mean(), 0);
        EXPECT_EQ(remainder.at(Component::emission).mean(), 0);
    }
}

// Area lights are found by the camera's walk: nothing remains.
TEST(VcmPlan, LeavesNoRemainderUnderALamp) {
    const auto scene = room({.light = lamp, .ball = glass_ball});
    const Plan plan = ConfiguredMethod(MethodLabel::parse("vcm techniques=remainder")).create({})->plan(*scene.scene);
    EXPECT_FALSE(plan.runs("merging"));
    EXPECT_EQ(test::mean_of(test::render(scene, "vcm techniques=remainder", 4).total()).sum(), 0);
}

}  // namespace
}  // namespace gib::vcm_test
