// Sentences of a tuning on times that the test sets: factors, speed over the defaults, changes, what was cut; and `gibench tune`
// and an experiment with [tune] as commands on a tiny scene.
#include "experiments/tuning/tuning_page.h"
#include "experiments/tuning/tuning_text.h"

#include "tests/support/run_fixtures.h"
#include "tests/support/table_fixtures.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace gib::test::tuning_result_test {
namespace {

/// A setting with times of about `seconds`, 1 % apart.
FinalSetting setting(const std::string& label, std::size_t method, double seconds) {
    FinalSetting s{.label = MethodLabel::parse(label), .method = method, .cells = {}};
    for (int seed = 2; seed <= 6; ++seed) {
        Cell cell;
        // The squared error is 1 / passes, one pass a hundredth of a second at `seconds` = 1.
        for (std::uint32_t passes = 1; passes <= 1024; passes *= 2)
            cell.checkpoints.push_back(
                checkpoint_of(passes, 0.01 * passes * seconds * (1 + 0.01 * (seed - 4)), 1.0 / passes));
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
    for (const char* line :
         {"cannot be told from the best: photon_mapper photons=20000 (photons doubled)\n",
          "times as long: photon_mapper photons=10000 k=100 (k doubled)\n",
          "times as long: photon_mapper (the defaults)\n", "times as long: path\n", "cut: the search ended early\n"})
        EXPECT_THAT(tuning_text(example()), HasSubstr(line));
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
    EXPECT_THAT(tuning_html(example()),
                AllOf(HasSubstr("default-src 'none'"), HasSubstr("<code>photon_mapper photons=10000 spp=100</code>"),
                      HasSubstr("One step from the cheapest settings"), Not(HasSubstr("{{"))));
    TuningResult nothing = example();
    for (auto& f : nothing.finals)
        f.log_times.clear();
    EXPECT_THAT(tuning_html(nothing), HasSubstr("No method reached 10% in the final runs"));
}

class TuneRun : public ::testing::Test, protected ExperimentFolder {
protected:
    TuneRun() {
        write("e.toml",
              "scenes = ['tiny.xml']\n[tune]\ntarget = '60%'\nminutes = 0.8\n"
              "method = 'photon_mapper photons=1000 area=plain gather=8 cache=on accuracy=0.5'\n"
              "vary = 'k=20..100'\n");
    }
};

TEST_F(TuneRun, AnExperimentWithTuneDoesWhatTheCommandDoes) {
    const ProgramResult run_result = gibench("run e.toml --out r");
    ASSERT_EQ(run_result.code, 0) << run_result.err;
    EXPECT_THAT(run_result.out, AllOf(StartsWith("tiny:\nphoton_mapper"), HasSubstr("seconds to 60%: ")));
    for (const char* file : {"tune.html", "tune.json", "clock.json", "final/table.csv", "final/report.html"})
        EXPECT_TRUE(fs::exists(path("r/tiny/" + std::string(file)))) << file;
    // The command finds everything stored, which takes no time, and so finds the same.
    const ProgramResult command = gibench(
        "tune tiny.xml --target 60% --minutes 0.8 --vary k=20..100 --out r/tiny "
        "--method 'photon_mapper photons=1000 area=plain gather=8 cache=on accuracy=0.5'");
    ASSERT_EQ(command.code, 0) << command.err;
    EXPECT_EQ("tiny:\n" + command.out, run_result.out);
    EXPECT_THAT(command.err, AllOf(HasSubstr("cells complete already, not done again"), Not(HasSubstr("cell 1 of"))));
}

TEST_F(TuneRun, NamesThePlaceOfAWrongVariation) {
    write("wrong.toml", "scenes = ['tiny.xml']\n[tune]\nmethod = 'path'\nvary = ['k=20..100']\n");
    EXPECT_THAT(gibench("run wrong.toml"),
                exits(2, StartsWith("wrong.toml:4:9: vary: no method here has a parameter 'k'")));
    EXPECT_FALSE(fs::exists(path("results")));
}

TEST_F(TuneRun, RefusesOptionsOfCells) {
    for (const char* option : {"--seeds 3", "--fresh", "--only nothing"})
        EXPECT_EQ(gibench(std::string("run e.toml ") + option).code, 2);
    EXPECT_FALSE(fs::exists(path("results")));
}

TEST_F(TuneRun, BeginsNoCellWhenItsTimeIsUsedUp) {
    // In 6 s there is no time for 43 settings, some of which trace 1e7 photons.
    EXPECT_THAT(gibench("tune tiny.xml --target 30% --minutes 0.1 --method photon_mapper --out r").err,
                HasSubstr("no time is left for "));
    EXPECT_LT(std::distance(fs::directory_iterator(path("r/1-photon_mapper-1/cells")), {}), 43);
    const auto numbers = nlohmann::json::parse(read_file(path("r/tune.json")));
    EXPECT_THAT(numbers["notes"].dump(), HasSubstr("the search among settings of photon_mapper ended early"));
}

}  // namespace
}  // namespace gib::test::tuning_result_test
