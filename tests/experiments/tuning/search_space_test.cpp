// Tests of what `gibench tune` varies: declared spans, requests of the command line, neighbours.
#include "experiments/tuning/search_space.h"

#include "common/core/error.h"
#include "methods/method.h"

#include <gmock/gmock.h>

namespace gib {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> texts(const std::vector<MethodLabel>& labels) {
    std::vector<std::string> result;
    for (const auto& label : labels)
        result.push_back(label.text());
    return result;
}

TEST(SearchSpace, IsWhatTheParametersDeclare) {
    const auto axes = tuning_axes(MethodLabel::parse("photon_mapper"), {});
    ASSERT_EQ(axes.size(), 2u);
    EXPECT_EQ(axes[0].name, "photons");
    EXPECT_EQ(axes[0].at(0), "10000");
    EXPECT_EQ(axes[0].at(0.5), "320000") << "the geometric mean, with two digits";
    EXPECT_EQ(axes[0].at(1), "10000000");
    EXPECT_TRUE(tuning_axes(MethodLabel::parse("path"), {}).empty());
    EXPECT_EQ(tuning_axes(MethodLabel::parse("photon_mapper k=80"), {}).size(), 1u) << "a given parameter stays";
}

TEST(SearchSpace, SpansLieInTheRangesOfTheirParameters) {
    for (const auto& method : method_registry())
        for (const auto& p : method.parameters) {
            if (!p.tuning) continue;
            EXPECT_LT(p.tuning->lower, p.tuning->upper) << method.name << " " << p.name;
            EXPECT_GE(p.tuning->lower, p.lower) << method.name << " " << p.name;
            EXPECT_LE(p.tuning->upper, p.upper) << method.name << " " << p.name;
        }
}

TEST(SearchSpace, TakesRequestsOfTheCommandLine) {
    const auto axes = tuning_axes(MethodLabel::parse("photon_mapper k=80"),
                                  {parse_variation("photons=1e3..1e5"), parse_variation("cache=on,off")});
    ASSERT_EQ(axes.size(), 2u);
    EXPECT_EQ(axes[0].at(0.5), "10000");
    EXPECT_EQ(axes[1].at(0.4), "on");
    EXPECT_EQ(axes[1].at(0.6), "off");
    for (const char* wrong : {"photons", "photons=", "=1..2", "photons=2..1", "photons=a..b", "cache=on,,off"})
        EXPECT_THROW(parse_variation(wrong), InputError) << wrong;
    EXPECT_THROW(tuning_axes(MethodLabel::parse("photon_mapper"), {parse_variation("k=0..9")}), InputError);
    EXPECT_THROW(tuning_axes(MethodLabel::parse("photon_mapper k=80"), {parse_variation("k=9..90")}), InputError);
    EXPECT_THROW(tuning_axes(MethodLabel::parse("photon_mapper"), {parse_variation("cache=1..2")}), InputError);
}

TEST(SearchSpace, NeighboursAreHalfAndDouble) {
    const auto label = MethodLabel::parse("photon_mapper photons=2e5");
    EXPECT_THAT(
        texts(neighbours(label, tuning_axes(MethodLabel::parse("photon_mapper"), {parse_variation("cache=on,off")}))),
        ElementsAre("photon_mapper photons=100000", "photon_mapper photons=400000", "photon_mapper photons=2e5 k=25",
                    "photon_mapper photons=2e5 k=100", "photon_mapper photons=2e5 cache=on"));
    // The range of k begins at 2.
    EXPECT_THAT(texts(neighbours(MethodLabel::parse("photon_mapper photons=10 k=2"),
                                 tuning_axes(MethodLabel::parse("photon_mapper photons=10"), {}))),
                ElementsAre("photon_mapper photons=10 k=4"));
}

TEST(SearchSpace, CandidatesAreTheDefaultsAndAnEvenCover) {
    const auto base = MethodLabel::parse("photon_mapper k=80");
    EXPECT_THAT(texts(candidates(base, tuning_axes(base, {}), 3)),
                ElementsAre("photon_mapper k=80", "photon_mapper k=80 photons=320000",
                            "photon_mapper k=80 photons=56000", "photon_mapper k=80 photons=1800000"));
}

}  // namespace
}  // namespace gib
