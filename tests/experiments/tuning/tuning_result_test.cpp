// Tests of what a tuning says of times that the test sets: factors, speed over the defaults, changes, what was cut.
#include "experiments/tuning/tuning_page.h"
#include "experiments/tuning/tuning_text.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace gib::tuning_result_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A setting with times of about `seconds`, 1 % apart.
FinalSetting setting(const std::string& label, std::size_t method, double seconds) {
    FinalSetting s{.label = MethodLabel::parse(label), .method = method, .cells = {}};
    for (int seed = 2; seed <= 6; ++seed) {
        Cell cell;
        // The squared error is 1 / passes, one pass a hundredth of a second at `seconds` = 1.
        for (std::uint32_t passes = 1; passes <= 1024; passes *= 2)
            cell.checkpoints.push_back({{passes, 0.01 * passes * seconds * (1 + 0.01 * (seed - 4)), {}, 0},
                                        {{"total", {0, 0, 0, 0, 1.0 / passes}}}});
        s.cells.push_back(cell);
        s.log_times.push_back(std::log(seconds * (1 + 0.01 * (seed - 4))));
    }
    s.mean = sample_mean(s.log_times);
    return s;
}

TuningResult example() {
    TuningResult result{.scene = "box", .target = "10%", .target_error = 0.1, .final_budget = 6, .minutes = 1};
    const auto base = MethodLabel::parse("photon_mapper");
    result.methods.push_back({base,
                              tuning_axes(base, {}),
                              {{MethodLabel::parse("photon_mapper photons=10000"), {1, true}},
                               {base, {3, false}},
                               {MethodLabel::parse("photon_mapper k=400"), {}}}});
    result.methods.push_back({MethodLabel::parse("path"), {}, {}});
    result.finals = {setting("photon_mapper photons=10000", 0, 1), setting("photon_mapper photons=20000", 0, 1.002),
                     setting("photon_mapper photons=10000 k=100", 0, 1.5), setting("photon_mapper", 0, 3),
                     setting("path", 1, 9)};
    result.notes = {"the search ended early"};
    return result;
}

TEST(TuningResult, SaysHowMuchFasterThanTheDefaultsTheBestIs) {
    TuningResult result = example();
    ASSERT_EQ(speedups(result).size(), 1u) << "path has nothing to vary";
    EXPECT_NEAR(speedups(result).front().factor->value, 3, 1e-9);
    EXPECT_THAT(tuning_text(result),
                HasSubstr("photon_mapper is 3.00 (2.92 to 3.08) times faster than with its defaults\n"));
    // The defaults do not reach the target in final runs of 6 s.
    result.finals[3].log_times.clear();
    EXPECT_THAT(tuning_text(result), HasSubstr("photon_mapper is at least 6.00 times faster than with its defaults"));
    // The defaults are the best.
    std::swap(result.finals[0], result.finals[3]);
    result.finals[0] = setting("photon_mapper", 0, 0.9);
    EXPECT_THAT(tuning_text(result), HasSubstr("photon_mapper is fastest with its defaults"));
}

TEST(TuningResult, BeginsWithTheLabelToPaste) {
    EXPECT_THAT(tuning_text(example()), StartsWith("photon_mapper photons=10000 spp=100\nseconds to 10%: 1.000 ("));
}

TEST(TuningResult, NamesChangesAndWhatCannotBeToldApart) {
    const std::string text = tuning_text(example());
    EXPECT_THAT(text, HasSubstr("cannot be told from the best: photon_mapper photons=20000 (photons doubled)\n"));
    EXPECT_THAT(text, HasSubstr("times as long: photon_mapper photons=10000 k=100 (k doubled)\n"));
    EXPECT_THAT(text, HasSubstr("times as long: photon_mapper (the defaults)\n"));
    EXPECT_THAT(text, HasSubstr("times as long: path\n"));
    EXPECT_THAT(text, HasSubstr("cut: the search ended early\n"));
}

TEST(TuningResult, HasItsNumbersAsJson) {
    const auto numbers = nlohmann::json::parse(tuning_json(example()));
    EXPECT_EQ(numbers["best"]["paste"], "photon_mapper photons=10000 spp=100");
    EXPECT_NEAR(numbers["best"]["seconds"].get<double>(), 1, 1e-3);
    const auto& tuned = numbers["tuned"][0];
    EXPECT_EQ(tuned["parameters"][0]["name"], "photons");
    EXPECT_EQ(tuned["settings"][0]["values"][0], "10000");
    EXPECT_EQ(tuned["settings"][1]["values"][0], "1000000") << "the default counts";
    EXPECT_TRUE(tuned["settings"][2]["seconds"].is_null()) << "never";
    // The accuracy of the cache has no effect without the cache.
    for (std::size_t p = 0; p < tuned["parameters"].size(); ++p)
        EXPECT_EQ(tuned["settings"][0]["values"][p] == "",
                  tuned["parameters"][p]["name"] == "accuracy" || tuned["parameters"][p]["name"] == "cache")
            << p;
}

TEST(TuningResult, HasAPageThatOpensOffline) {
    const std::string page = tuning_html(example());
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_THAT(page, HasSubstr("<code>photon_mapper photons=10000 spp=100</code>"));
    EXPECT_THAT(page, HasSubstr("One step from the cheapest settings"));
    EXPECT_THAT(page, Not(HasSubstr("{{")));
    TuningResult nothing = example();
    for (auto& f : nothing.finals)
        f.log_times.clear();
    EXPECT_THAT(tuning_html(nothing), HasSubstr("No method reached 10% in the final runs"));
}

}  // namespace
}  // namespace gib::tuning_result_test
