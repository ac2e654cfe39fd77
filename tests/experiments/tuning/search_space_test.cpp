// Tests of what `gibench tune` varies: declared spans, requests of the command line, the cover.
#include "experiments/tuning/search_space.h"

#include "common/core/error.h"
#include "methods/method.h"
#include "tests/support/matchers.h"

#include <algorithm>
#include <set>

namespace gib::test::search_space_test {
namespace {

MethodLabel label_of(const std::string& text) { return MethodLabel::parse(text); }

SearchSpace space_of(const std::string& label, const std::vector<Variation>& variations = {}) {
    return {label_of(label), tuning_axes(label_of(label), variations)};
}

const TuningAxis& axis_named(const SearchSpace& space, const std::string& name) {
    return *std::find_if(space.axes().begin(), space.axes().end(), [&](const TuningAxis& a) { return a.name == name; });
}

TEST(SearchSpace, IsWhatTheParametersDeclare) {
    const SearchSpace space = space_of("photon_mapper");
    std::vector<std::string> names;
    for (const auto& axis : space.axes())
        names.push_back(axis.name);
    EXPECT_THAT(names, ElementsAre("photons", "k", "area", "direct_samples", "gather", "cache", "accuracy"));
    EXPECT_EQ(space.axes()[0].at(0), 10000);
    EXPECT_EQ(space.axes()[0].at(0.25), 32000) << "the logarithm grows evenly; two digits";
    EXPECT_EQ(space.axes()[0].at(1), 1e6);
    EXPECT_THAT(axis_named(space, "cache").words, ElementsAre("off", "on"));
    EXPECT_TRUE(space_of("path").axes().empty());
    EXPECT_EQ(space_of("photon_mapper k=80").axes().size(), 6u) << "a given parameter stays";
}

TEST(SearchSpace, ADefaultApartFromItsSpanHasAQuarter) {
    const TuningAxis gather = axis_named(space_of("photon_mapper"), "gather");
    EXPECT_EQ(gather.at(0.2), 0);
    EXPECT_EQ(gather.at(0.25), 16);
    EXPECT_EQ(gather.at(1), 510);
    const auto asked = space_of("photon_mapper", {parse_variation("gather=16..64")});
    EXPECT_EQ(axis_named(asked, "gather").at(0.2), 21) << "a range that was asked for is all there is";
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
    const SearchSpace space =
        space_of("photon_mapper k=80 gather=9", {parse_variation("photons=1e3..1e5"), parse_variation("cache=on,off")});
    EXPECT_EQ(axis_named(space, "photons").at(0.5), 10000);
    const TuningAxis& cache = axis_named(space, "cache");
    EXPECT_EQ(cache.text(cache.at(0.4)), "on");
    EXPECT_EQ(cache.text(cache.at(0.6)), "off");
    for (const char* wrong : {"photons", "photons=", "=1..2", "photons=2..1", "photons=a..b", "cache=on,,off"})
        EXPECT_THROW(parse_variation(wrong), InputError) << wrong;
    EXPECT_THROW(space_of("photon_mapper", {parse_variation("k=0..9")}), InputError);
    EXPECT_THROW(space_of("photon_mapper k=80", {parse_variation("k=9..90")}), InputError);
    EXPECT_THROW(space_of("photon_mapper", {parse_variation("cache=1..2")}), InputError);
}

TEST(SearchSpace, TheCoverIsEvenAndBeginsWithTheDefaults) {
    const SearchSpace space = space_of("photon_mapper k=80 area=plain");
    const auto settings = space.cover(64);
    EXPECT_EQ(space.label(settings.front()).text(), "photon_mapper k=80 area=plain");
    int few = 0, gathered = 0, cached = 0;
    std::set<std::string> unique;
    for (std::size_t i = 1; i < settings.size(); ++i) {
        const MethodLabel label = space.label(settings[i]);
        EXPECT_NO_THROW(ConfiguredMethod(label).create(MethodDefaults{})) << label.text();
        EXPECT_TRUE(unique.insert(label.text()).second) << label.text();
        for (std::size_t d = 0; d < space.axes().size(); ++d) {
            const auto value = space.effective(settings[i], d);
            few += space.axes()[d].name == "photons" && *value < 1e5;
            gathered += space.axes()[d].name == "gather" && *value > 0;
            cached += space.axes()[d].name == "cache" && value == 1;
        }
    }
    EXPECT_NEAR(few, 32, 2) << "half of the settings have less than the mean in the logarithm";
    EXPECT_NEAR(gathered, 48, 2);
    EXPECT_NEAR(cached, 24, 6) << "half of those that gather";
}

}  // namespace
}  // namespace gib::test::search_space_test
