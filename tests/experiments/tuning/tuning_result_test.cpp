// Sentences of a tuning on times that the test sets: verdicts, factors, gains over the defaults, what was cut; and
// `gibench tune` and an experiment with [tune] as commands on a tiny scene.
#include "experiments/tuning/tuning_result.h"

#include "tests/support/run_fixtures.h"
#include "tests/support/table_fixtures.h"

#include <nlohmann/json.hpp>

#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <thread>

namespace gib::test::tuning_result_test {
namespace {

/// Runs whose squared error is 1 / passes, a pass a hundredth of a second at `seconds` = 1, and five seeds 1 % apart.
Verdict verdict(double seconds, std::uint32_t most_passes = 1024) {
    std::vector<Cell> cells;
    for (int seed = 1; seed <= 5; ++seed) {
        Cell& cell = cells.emplace_back();
        for (std::uint32_t passes = 1; passes <= most_passes; passes *= 2)
            cell.checkpoints.push_back(
                checkpoint_of(passes, 0.01 * passes * seconds * (1 + 0.01 * (seed - 3)), 1.0 / passes));
    }
    return verdict_of(cells, 0.1, true);
}

/// The best settings of two methods, and the defaults of the first.
TuningResult example() {
    const MethodLabel base{"photon_mapper", {}}, path{"path", {}};
    TuningResult result{.scene = "box", .target = "10%", .minutes = 1};
    result.methods = {{{base, tuning_axes(base, {})}}, {{path, {}}, true}};
    const Setting defaults = result.methods[0].space.defaults();
    Setting few = defaults, half = defaults;
    few[0] = half[0] = 1e4;
    half[1] = 25;
    result.methods[0].trials = {{few, {1, true}}, {defaults, {3, false}}, {half, {}}};
    result.finals = {{0, few, true, 6, verdict(1)}, {1, {}, true, 6, verdict(9)}, {0, defaults, false, 6, verdict(3)}};
    result.notes = {"the search ended early"};
    return result;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

TEST(TuningResult, BeginsWithTheLabelToPasteAndEndsWithAVerdictOfEachMethod) {
    const auto lines = lines_of(tuning_text(example()));
    EXPECT_EQ(lines.front(), "photon_mapper photons=10000 spp=100");
    EXPECT_THAT(lines[1], StartsWith("seconds to 10%: 1.000 ("));
    EXPECT_THAT(lines[lines.size() - 2],
                ContainsRegex("^photon_mapper photons=10000 spp=100: 10% after 1.000 \\(.*\\) s, measured$"));
    EXPECT_THAT(tuning_text(example()), HasSubstr("\ncut: the search ended early\n"));
    EXPECT_THAT(lines.back(), ContainsRegex("^path spp=100: 10% after 9.00 \\(.*\\) s, measured$"));
}

// The first method is three times as fast, but makes no image that shows all light.
TEST(TuningResult, PrefersMethodsThatLeaveOutNothing) {
    TuningResult result = example();
    result.methods[0].left_out.components = {Component::caustic};
    ASSERT_NE(result.best(), nullptr);
    EXPECT_EQ(result.best()->method, 1u);
    const auto lines = lines_of(tuning_text(result));
    EXPECT_EQ(lines.front(), "path spp=100");
    EXPECT_THAT(lines[lines.size() - 2], HasSubstr(" s, measured, leaves out light of caustic"));
    result.methods[1].left_out.components = {Component::caustic};
    EXPECT_EQ(result.best()->method, 0u) << "none makes all light";
}

class TuneRun : public ::testing::Test, protected ExperimentFolder {
protected:
    TuneRun() {
        write("e.toml",
              "scenes = ['tiny.xml']\n[tune]\ntarget = '60%'\nminutes = 0.4\n"
              "method = 'photon_mapper photons=1000 area=plain direct_samples=1 gather=8 cache=on accuracy=0.5'\n"
              "vary = 'k=20..100'\n");
    }
    static std::string last_line(const ProgramResult& result) { return lines_of(result.out).back(); }
    /// The number of complete cells in a result folder.
    std::size_t cells_in(const std::string& folder) const {
        std::size_t count = 0;
        if (fs::exists(path(folder + "/cells")))
            for (const auto& cell : fs::directory_iterator(path(folder + "/cells")))
                count += fs::exists(cell.path() / "cell.json") ? 1 : 0;
        return count;
    }
};

TEST_F(TuneRun, AnExperimentWithTuneDoesWhatTheCommandDoes) {
    const ProgramResult run_result = gibench("run e.toml --out r");
    ASSERT_EQ(run_result.code, 0) << run_result.err;
    EXPECT_THAT(run_result.out, AllOf(StartsWith("tiny:\nphoton_mapper"), HasSubstr("seconds to 60%: ")));
    for (const char* file : {"tune.json", "table.csv", "report.html"})
        EXPECT_TRUE(fs::exists(path("r/tiny/" + std::string(file)))) << file;
    EXPECT_THAT(read_file(path("r/tiny/report.html")), HasSubstr("The cheapest settings for 60%"));
    // The command finds everything stored, which takes no time, and so finds the same.
    const ProgramResult command = gibench(
        "tune tiny.xml --target 60% --minutes 0.4 --vary k=20..100 --out r/tiny "
        "--method 'photon_mapper photons=1000 area=plain direct_samples=1 gather=8 cache=on accuracy=0.5'");
    ASSERT_EQ(command.code, 0) << command.err;
    EXPECT_EQ("tiny:\n" + command.out, run_result.out);
    EXPECT_THAT(command.err, Not(HasSubstr("cell 1 of")));
    EXPECT_EQ(gibench("report r/tiny").code, 0);
    EXPECT_THAT(read_file(path("r/tiny/report.html")), HasSubstr("The cheapest settings for 60%"));
}

TEST_F(TuneRun, GoesOnAfterAnInterruption) {
    const std::string command =
        "tune tiny.xml --target 60% --minutes 0.4 --vary k=20..100 --out r --method 'photon_mapper photons=1000 "
        "gather=0 "
        "area=plain direct_samples=1'";
    BackgroundRun first(path(), command);
    ASSERT_TRUE(comes_true([&] { return cells_in("r") > 2; })) << first.said();
    EXPECT_EQ(first.interrupt(SIGINT), 130);
    std::map<std::string, fs::file_time_type> before;
    for (const auto& cell : fs::directory_iterator(path("r/cells")))
        if (fs::exists(cell.path() / "cell.json"))
            before[cell.path().filename()] = fs::last_write_time(cell.path() / "cell.json");
    const ProgramResult second = gibench(command);
    EXPECT_THAT(last_line(second), StartsWith("photon_mapper"));
    for (const auto& [name, time] : before)
        EXPECT_EQ(fs::last_write_time(path("r/cells/" + name + "/cell.json")), time) << name;
}

TEST_F(TuneRun, StopsWhereTheReferencesNoiseHidesTheTarget) {
    const std::string tune = "tune tiny.xml --target 0.5% --method path --out r --minutes ";
    const ProgramResult coarse = gibench(tune + "0.001");
    EXPECT_EQ(coarse.code, 1);
    EXPECT_THAT(coarse.err, HasSubstr("the reference's noise hides 0.5%: its own error is "));
    EXPECT_EQ(cells_in("r"), 0u) << "nothing is searched";
    // The tuning takes what the command makes that is named.
    const auto begin = coarse.err.find("reference tiny.xml --target 0.125% -o results/references/");
    ASSERT_NE(begin, std::string::npos) << coarse.err;
    ASSERT_EQ(gibench(coarse.err.substr(begin, coarse.err.find('\n', begin) - begin)).code, 0);
    const ProgramResult better = gibench(tune + "0.1");
    EXPECT_THAT(better.out, ContainsRegex("path( spp=[0-9]+)?: 0.5% (after|not reached)")) << better.err;
}

TEST_F(TuneRun, EveryMethodHasAVerdict) {
    const ProgramResult result = gibench(
        "tune tiny.xml --target 5% --minutes 0.5 --out r --method path --method 'photon_mapper photons=100 gather=0 "
        "k=50 "
        "area=plain direct_samples=1' --method 'radiosity patch=1'");
    EXPECT_EQ(result.code, 0) << result.err;
    const auto lines = lines_of(result.out);
    ASSERT_GE(lines.size(), 3u);
    for (std::size_t i = lines.size() - 3; i < lines.size(); ++i)
        EXPECT_THAT(lines[i], ContainsRegex("^[a-z_]+.*: 5% .*(measured|extrapolated|not reached)")) << lines[i];
    EXPECT_THAT(result.out, ContainsRegex("\npath spp=[0-9]+: 5% after .* s, measured"));
    EXPECT_THAT(result.out, AllOf(HasSubstr("\nseconds to 10 %: "), Not(HasSubstr("\nseconds to 5 %: "))))
        << "the target has a line already";
}

TEST_F(TuneRun, FinalRunsHaveSeedsThatChoseNothing) {
    ASSERT_NE(
        gibench(
            "tune tiny.xml --target 60% --minutes 0.4 --vary k=20..100 --out r --method 'photon_mapper photons=1000 "
            "gather=0 area=plain direct_samples=1'")
            .code,
        2);
    std::set<std::uint64_t> choosing, final_seeds;
    for (const auto& cell : fs::directory_iterator(path("r/cells"))) {
        const auto record = nlohmann::json::parse(read_file(cell.path() / "cell.json"));
        const bool is_final = cell.path().filename().string().ends_with("s") == false;
        (is_final ? final_seeds : choosing).insert(record.at("seed").get<std::uint64_t>());
    }
    EXPECT_FALSE(final_seeds.empty());
    EXPECT_FALSE(choosing.empty());
    for (const std::uint64_t seed : final_seeds)
        EXPECT_EQ(choosing.count(seed), 0u) << seed;
}

// Other threads use all cores, so that runs take twice as long as alone, or more.
TEST_F(TuneRun, AnswersOnABusyMachine) {
    std::atomic<bool> done = false;
    std::vector<std::thread> busy;
    for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i)
        busy.emplace_back([&] {
            while (!done)
                ;
        });
    const ProgramResult result = gibench("tune tiny.xml --target 20% --minutes 0.4 --method path --out r");
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(last_line(result), AllOf(StartsWith("path spp="), HasSubstr(", measured")));
    done = true;
    for (std::thread& one : busy)
        one.join();
}

TEST_F(TuneRun, NamesThePlaceOfAWrongVariation) {
    write("wrong.toml", "scenes = ['tiny.xml']\n[tune]\nmethod = 'path'\nvary = ['k=20..100']\n");
    EXPECT_THAT(gibench("run wrong.toml"),
                exits(2, StartsWith("wrong.toml:4:9: vary: no method here has a parameter 'k'")));
    EXPECT_FALSE(fs::exists(path("results")));
}

TEST_F(TuneRun, TakesNumbersThatAreNotThoseOfToml) {
    const ProgramResult result = gibench(
        "tune tiny.xml --target 60% --minutes 0.1 --out r --vary radius=.05,1. --method 'photon_mapper photons=01000 "
        "gather=0 area=plain direct_samples=1'");
    EXPECT_THAT(result.out, HasSubstr("photon_mapper photons=01000 ")) << result.err;
    EXPECT_THAT(read_file(path("r/table.csv")), HasSubstr("photon_mapper photons=1000 "));
}

TEST_F(TuneRun, BeginsNoCellWhenItsTimeIsUsedUp) {
    // In 2.4 s there is no time for 71 settings, as some trace 1e7 photons.
    const ProgramResult result = gibench("tune tiny.xml --target 30% --minutes 0.04 --method photon_mapper --out r");
    EXPECT_THAT(result.err, HasSubstr("no time is left for "));
    EXPECT_LT(cells_in("r"), 71u);
    const auto numbers = nlohmann::json::parse(read_file(path("r/tune.json")));
    EXPECT_THAT(numbers["cuts"].dump(), HasSubstr("the search among settings of photon_mapper ended early"));
    EXPECT_THAT(last_line(result), StartsWith("photon_mapper"));
}

}  // namespace
}  // namespace gib::test::tuning_result_test
