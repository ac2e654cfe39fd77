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

SearchSpace space_of(const std::string& label, const std::vector<Variation>& variations = {}) {
    return {label_of(label), tuning_axes(label_of(label), variations)};
}

/// The setting of these values, which stand in a label behind the base's own.
Setting setting_in(const SearchSpace& space, const std::string& values) {
    Setting setting = space.defaults();
    for (const auto& [name, value] : label_of("any " + values).values)
        for (std::size_t d = 0; d < space.axes().size(); ++d) {
            const TuningAxis& axis = space.axes()[d];
            if (axis.name != name) continue;
            const auto word = std::find(axis.words.begin(), axis.words.end(), value);
            setting[d] = word != axis.words.end() ? static_cast<double>(word - axis.words.begin()) : std::stod(value);
        }
    return setting;
}

std::vector<std::string> texts(const SearchSpace& space, const std::vector<Setting>& settings) {
    std::vector<std::string> result;
    for (const Setting& setting : settings)
        result.push_back(space.label(setting).text());
    return result;
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

TEST(SearchSpace, LabelsHaveNumbersOfTwoDigits) {
    const SearchSpace space = space_of("photon_mapper");
    EXPECT_EQ(space.label(setting_in(space, "photons=32000 gather=64 cache=on accuracy=0.3")).text(),
              "photon_mapper photons=32000 gather=64 cache=on accuracy=0.3");
    EXPECT_EQ(axis_named(space, "photons").text(axis_named(space, "photons").rounded(123456)), "120000");
    EXPECT_EQ(axis_named(space, "accuracy").text(axis_named(space, "accuracy").rounded(0.1549)), "0.15");
}

TEST(SearchSpace, AChangeIsRepeatedByItsFactor) {
    const SearchSpace space = space_of("photon_mapper");
    const auto repeated = [&](const char* from, const char* to) {
        return space.label(space.with_change_repeated(setting_in(space, from), setting_in(space, to))).text();
    };
    EXPECT_EQ(repeated("photons=8000 k=80", "photons=4000 k=40 area=plain"),
              "photon_mapper photons=2000 k=20 area=plain");
    EXPECT_EQ(repeated("", "photons=500000"), "photon_mapper photons=250000")
        << "a value that is not given is the default";
    EXPECT_EQ(repeated("k=20", "k=2"), "photon_mapper k=2") << "the range ends at 2";
    EXPECT_EQ(repeated("gather=9", "gather=9 cache=on"), "photon_mapper gather=9 cache=on");
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

TEST(SearchSpace, NeighboursAreHalfAndDouble) {
    const std::string base = "photon_mapper area=plain direct_samples=1 gather=64";
    const SearchSpace space = space_of(base);
    const auto around = [](const SearchSpace& of, const std::string& values) {
        return texts(of, of.neighbours(setting_in(of, values)));
    };
    EXPECT_THAT(around(space, "photons=2e5"), ElementsAre(base + " photons=100000 k=25", base + " photons=400000 k=100",
                                                          base + " photons=200000 k=25", base + " photons=200000 k=100",
                                                          base + " photons=200000 cache=on"))
        << "k follows the photons; without the cache, its accuracy has no effect";
    EXPECT_THAT(around(space, "photons=2e5 cache=on accuracy=0.3"),
                ElementsAre(base + " photons=100000 k=25 cache=on accuracy=0.3",
                            base + " photons=400000 k=100 cache=on accuracy=0.3",
                            base + " photons=200000 k=25 cache=on accuracy=0.3",
                            base + " photons=200000 k=100 cache=on accuracy=0.3", base + " photons=200000",
                            base + " photons=200000 cache=on", base + " photons=200000 cache=on accuracy=0.6"));
    // The range of k begins at 2.
    const std::string few = "photon_mapper photons=10 area=plain direct_samples=1 gather=64 cache=off";
    EXPECT_THAT(around(space_of(few), "k=2"), ElementsAre(few + " k=4"));
}

TEST(SearchSpace, AWordHasNoHalf) {
    const std::string base = "photon_mapper k=auto area=plain direct_samples=1 gather=64 cache=off";
    const SearchSpace space = space_of(base);
    EXPECT_THAT(texts(space, space.neighbours(setting_in(space, "photons=2e5"))),
                ElementsAre(base + " photons=100000", base + " photons=400000"));
}

TEST(SearchSpace, StepsLeadToADefaultApartAndBack) {
    const std::string base = "photon_mapper photons=10 k=9 area=plain cache=off";
    const SearchSpace space = space_of(base);
    const auto around = [&](const char* values) { return texts(space, space.neighbours(setting_in(space, values))); };
    EXPECT_THAT(around(""), Contains(base + " gather=16"));
    EXPECT_THAT(around(""), Not(Contains(base + " gather=8")));
    EXPECT_THAT(around("gather=16"), AllOf(Contains(base), Contains(base + " gather=32")));
}

TEST(SearchSpace, TakesAllChangesThatGainTogether) {
    const SearchSpace space = space_of("photon_mapper area=plain gather=64");
    std::vector<Setting> better;
    for (const char* values : {"photons=2e5 k=100 cache=on", "photons=1e5 cache=on", "photons=4e5 cache=on"})
        better.push_back(setting_in(space, values));
    EXPECT_EQ(space.label(space.with_all_changes(setting_in(space, "photons=2e5 cache=on"), better)).text(),
              "photon_mapper area=plain gather=64 photons=100000 k=100 cache=on");
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
