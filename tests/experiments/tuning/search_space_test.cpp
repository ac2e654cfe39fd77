// Tests of what `gibench tune` varies: declared spans, requests of the command line, neighbours.
#include "experiments/tuning/search_space.h"

#include "common/core/error.h"
#include "methods/method.h"
#include "tests/support/matchers.h"

#include <algorithm>
#include <set>

namespace gib::test::search_space_test {
namespace {

MethodLabel label_of(const std::string& text) { return MethodLabel::parse(text); }

std::vector<TuningAxis> axes_of(const std::string& label) { return tuning_axes(label_of(label), {}); }

std::vector<std::string> texts(const std::vector<MethodLabel>& labels) {
    std::vector<std::string> result;
    for (const auto& label : labels)
        result.push_back(label.text());
    return result;
}

const TuningAxis& axis_named(const std::vector<TuningAxis>& axes, const std::string& name) {
    return *std::find_if(axes.begin(), axes.end(), [&](const TuningAxis& a) { return a.name == name; });
}

TEST(SearchSpace, IsWhatTheParametersDeclare) {
    const auto axes = axes_of("photon_mapper");
    std::vector<std::string> names;
    for (const auto& axis : axes)
        names.push_back(axis.name);
    EXPECT_THAT(names, ElementsAre("photons", "k", "area", "direct_samples", "gather", "cache", "accuracy"));
    EXPECT_EQ(axes[0].at(0), "10000");
    EXPECT_EQ(axes[0].at(0.25), "32000") << "the logarithm grows evenly; two digits";
    EXPECT_EQ(axes[0].at(1), "1000000");
    EXPECT_THAT(axis_named(axes, "cache").words, ElementsAre("off", "on"));
    EXPECT_TRUE(axes_of("path").empty());
    EXPECT_EQ(axes_of("photon_mapper k=80").size(), 6u) << "a given parameter stays";
}

TEST(SearchSpace, AChangeIsRepeatedByItsFactor) {
    const auto axes = axes_of("photon_mapper");
    const auto repeated = [&](const char* from, const char* to) {
        return with_change_repeated(label_of(from), label_of(to), axes).text();
    };
    EXPECT_EQ(repeated("photon_mapper photons=8000 k=80", "photon_mapper photons=4000 k=40 area=plain"),
              "photon_mapper photons=2000 k=20 area=plain");
    EXPECT_EQ(repeated("photon_mapper", "photon_mapper photons=500000"), "photon_mapper photons=250000")
        << "a value that is not given is the default";
    EXPECT_EQ(repeated("photon_mapper k=20", "photon_mapper k=2"), "photon_mapper k=2") << "the range ends at 2";
    EXPECT_EQ(repeated("photon_mapper gather=9", "photon_mapper gather=9 cache=on"), "photon_mapper gather=9 cache=on");
}

TEST(SearchSpace, ADefaultApartFromItsSpanHasAQuarter) {
    const auto axes = axes_of("photon_mapper");
    const TuningAxis& gather = axis_named(axes, "gather");
    EXPECT_EQ(gather.at(0.2), "0");
    EXPECT_EQ(gather.at(0.25), "16");
    EXPECT_EQ(gather.at(1), "510");
    const auto asked = tuning_axes(label_of("photon_mapper"), {parse_variation("gather=16..64")});
    EXPECT_EQ(axis_named(asked, "gather").at(0.2), "21") << "a range that was asked for is all there is";
}

TEST(SearchSpace, SpansLieInTheRangesOfTheirParameters) {
    for (const auto& method : method_registry())
        for (const auto& p : method.parameters) {
            if (!p.tuning) continue;
            EXPECT_LT(p.tuning->lower, p.tuning->upper) << method.name << " " << p.name;
            EXPECT_GE(p.tuning->lower, p.lower) << method.name << " " << p.name;
            const double most = p.choices.empty() || p.kind != Parameter::Kind::choice
                                    ? p.upper
                                    : static_cast<double>(p.choices.size() - 1);
            EXPECT_LE(p.tuning->upper, most) << method.name << " " << p.name;
        }
}

TEST(SearchSpace, TakesRequestsOfTheCommandLine) {
    const auto axes = tuning_axes(label_of("photon_mapper k=80 gather=9"),
                                  {parse_variation("photons=1e3..1e5"), parse_variation("cache=on,off")});
    EXPECT_EQ(axis_named(axes, "photons").at(0.5), "10000");
    EXPECT_EQ(axis_named(axes, "cache").at(0.4), "on");
    EXPECT_EQ(axis_named(axes, "cache").at(0.6), "off");
    for (const char* wrong : {"photons", "photons=", "=1..2", "photons=2..1", "photons=a..b", "cache=on,,off"})
        EXPECT_THROW(parse_variation(wrong), InputError) << wrong;
    EXPECT_THROW(tuning_axes(label_of("photon_mapper"), {parse_variation("k=0..9")}), InputError);
    EXPECT_THROW(tuning_axes(label_of("photon_mapper k=80"), {parse_variation("k=9..90")}), InputError);
    EXPECT_THROW(tuning_axes(label_of("photon_mapper"), {parse_variation("cache=1..2")}), InputError);
}

TEST(SearchSpace, NeighboursAreHalfAndDouble) {
    const auto base = label_of("photon_mapper area=plain direct_samples=1 gather=64");
    const auto axes = tuning_axes(base, {});
    EXPECT_THAT(texts(neighbours(label_of(base.text() + " photons=2e5"), axes)),
                ElementsAre(base.text() + " photons=100000 k=25", base.text() + " photons=400000 k=100",
                            base.text() + " photons=2e5 k=25", base.text() + " photons=2e5 k=100",
                            base.text() + " photons=2e5 cache=on"))
        << "k follows the photons; without the cache, its accuracy has no effect";
    EXPECT_THAT(texts(neighbours(label_of(base.text() + " photons=2e5 cache=on accuracy=0.3"), axes)),
                ElementsAre(base.text() + " photons=100000 k=25 cache=on accuracy=0.3",
                            base.text() + " photons=400000 k=100 cache=on accuracy=0.3",
                            base.text() + " photons=2e5 k=25 cache=on accuracy=0.3",
                            base.text() + " photons=2e5 k=100 cache=on accuracy=0.3", base.text() + " photons=2e5",
                            base.text() + " photons=2e5 cache=on", base.text() + " photons=2e5 cache=on accuracy=0.6"));
    // The range of k begins at 2.
    const auto few = label_of("photon_mapper photons=10 area=plain direct_samples=1 gather=64 cache=off");
    EXPECT_THAT(texts(neighbours(label_of(few.text() + " k=2"), tuning_axes(few, {}))),
                ElementsAre(few.text() + " k=4"));
    // A word does not follow.
    const auto word = label_of("photon_mapper area=plain direct_samples=1 gather=64 cache=off");
    EXPECT_THAT(texts(neighbours(label_of(word.text() + " photons=2e5 k=auto"), tuning_axes(word, {}))),
                ElementsAre(word.text() + " photons=100000 k=auto", word.text() + " photons=400000 k=auto"));
}

TEST(SearchSpace, StepsLeadToADefaultApartAndBack) {
    const auto base = label_of("photon_mapper photons=10 k=9 area=plain cache=off");
    const auto axes = tuning_axes(base, {});
    EXPECT_THAT(texts(neighbours(base, axes)), ElementsAre(base.text() + " gather=16"));
    EXPECT_THAT(texts(neighbours(label_of(base.text() + " gather=16"), axes)),
                ElementsAre(base.text(), base.text() + " gather=32"));
}

TEST(SearchSpace, TakesAllChangesThatGainTogether) {
    const auto base = label_of("photon_mapper area=plain gather=64");
    const auto label = label_of(base.text() + " photons=2e5 cache=on");
    EXPECT_EQ(with_all_changes(label,
                               {label_of(base.text() + " photons=2e5 k=100 cache=on"),
                                label_of(base.text() + " photons=100000 cache=on"),
                                label_of(base.text() + " photons=400000 cache=on")},
                               tuning_axes(base, {}))
                  .text(),
              base.text() + " photons=100000 k=100 cache=on");
}

TEST(SearchSpace, CandidatesAreTheDefaultsAndAnEvenCover) {
    const auto base = label_of("photon_mapper k=80 area=plain");
    const auto axes = tuning_axes(base, {});
    const auto labels = candidates(base, axes, 64);
    EXPECT_EQ(labels.front().text(), base.text());
    int few = 0, gathered = 0, cached = 0;
    for (std::size_t i = 1; i < labels.size(); ++i) {
        EXPECT_NO_THROW(ConfiguredMethod(labels[i]).create(MethodDefaults{})) << labels[i].text();
        few += std::stod(effective_value(labels[i], axis_named(axes, "photons"))) < 1e5;
        gathered += effective_value(labels[i], axis_named(axes, "gather")) != "0";
        cached += effective_value(labels[i], axis_named(axes, "cache")) == "on";
    }
    EXPECT_NEAR(few, 32, 2) << "half of the labels have less than the mean in the logarithm";
    EXPECT_NEAR(gathered, 48, 2);
    EXPECT_NEAR(cached, 24, 6) << "half of those that gather";
    std::set<std::string> unique;
    for (const auto& text : texts(labels))
        EXPECT_TRUE(unique.insert(text).second) << text;
}

}  // namespace
}  // namespace gib::test::search_space_test
