// `gibench tune` and an experiment with [tune], as commands on a tiny scene.
#include "tests/support/driver_fixtures.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gib::test::tune_run_test {
namespace {

using std::filesystem::begin;
using std::filesystem::end;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class TuneRun : public ::testing::Test {
protected:
    TuneRun() {
        folder_.write("tiny.xml", tiny_scene_xml());
        folder_.write("e.toml",
                      "scenes = ['tiny.xml']\n[tune]\ntarget = '60%'\nminutes = 0.8\n"
                      "method = 'photon_mapper photons=1000 area=plain gather=8 cache=on accuracy=0.5'\n"
                      "vary = 'k=20..100'\n");
    }
    ProgramResult run(const std::string& arguments) { return run_gibench(arguments, folder_ / ""); }
    TemporaryFolder folder_;
};

TEST_F(TuneRun, AnExperimentWithTuneDoesWhatTheCommandDoes) {
    const ProgramResult run_result = run("run e.toml --out r");
    ASSERT_EQ(run_result.code, 0) << run_result.err;
    EXPECT_THAT(run_result.out, StartsWith("tiny:\nphoton_mapper"));
    EXPECT_THAT(run_result.out, HasSubstr("seconds to 60%: "));
    for (const char* file : {"tune.html", "tune.json", "clock.json", "final/table.csv", "final/report.html"})
        EXPECT_TRUE(std::filesystem::exists(folder_ / ("r/tiny/" + std::string(file)))) << file;
    // The command finds everything stored, which takes no time, and so finds the same.
    const ProgramResult command =
        run("tune tiny.xml --target 60% --minutes 0.8 --vary k=20..100 --out r/tiny "
            "--method 'photon_mapper photons=1000 area=plain gather=8 cache=on accuracy=0.5'");
    ASSERT_EQ(command.code, 0) << command.err;
    EXPECT_EQ("tiny:\n" + command.out, run_result.out);
    EXPECT_THAT(command.err, HasSubstr("cells complete already, not done again"));
    EXPECT_THAT(command.err, Not(HasSubstr("cell 1 of")));
}

TEST_F(TuneRun, NamesThePlaceOfAWrongVariation) {
    folder_.write("wrong.toml", "scenes = ['tiny.xml']\n[tune]\nmethod = 'path'\nvary = ['k=20..100']\n");
    const ProgramResult result = run("run wrong.toml");
    EXPECT_EQ(result.code, 2);
    EXPECT_THAT(result.err, StartsWith("wrong.toml:4:9: vary: no method here has a parameter 'k'"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(TuneRun, RefusesOptionsOfCells) {
    EXPECT_EQ(run("run e.toml --seeds 3").code, 2);
    EXPECT_EQ(run("run e.toml --fresh").code, 2);
    EXPECT_EQ(run("run e.toml --only nothing").code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(TuneRun, BeginsNoCellWhenItsTimeIsUsedUp) {
    // In 6 s there is no time for 43 settings, some of which trace 1e7 photons.
    const ProgramResult result = run("tune tiny.xml --target 30% --minutes 0.1 --method photon_mapper --out r");
    EXPECT_THAT(result.err, HasSubstr("no time is left for "));
    const std::filesystem::directory_iterator cells(folder_ / "r/1-photon_mapper-1/cells");
    EXPECT_LT(std::distance(begin(cells), end(cells)), 43);
    const auto numbers = nlohmann::json::parse(read_file(folder_ / "r/tune.json"));
    EXPECT_THAT(numbers["notes"].dump(), HasSubstr("the search among settings of photon_mapper ended early"));
}

}  // namespace
}  // namespace gib::test::tune_run_test
