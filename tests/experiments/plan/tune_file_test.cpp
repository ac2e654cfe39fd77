// Experiment files with [tune]: their meaning, and the messages about wrong ones.
#include "experiments/plan/tune_file.h"

#include "tests/support/driver_fixtures.h"
#include "tests/support/input_error.h"

#include <gmock/gmock.h>

namespace gib::test::tune_file_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class TuneFileTest : public ::testing::Test {
protected:
    TuneFileTest() { folder_.write("a.xml", "<scene/>"); }
    TuneFile parse(const std::string& text) {
        return parse_tune_file("scenes = ['a.xml']\n" + text, folder_ / "e.toml").value();
    }
    std::string error_of(const std::string& text) {
        const std::string what = input_error_of([&] { parse(text); });
        const std::size_t place = what.find("e.toml");
        return place == std::string::npos ? what : what.substr(place);
    }
    TemporaryFolder folder_;
};

TEST_F(TuneFileTest, HasTheKeysOfTheCommandLine) {
    const TuneFile file = parse(
        "title = 'T'\nresolution = [8, 4]\nepsilon = 0.02\n[tune]\ntarget = '5%'\n"
        "method = ['photon_mapper gather=100 cache=on', 'path']\nvary = ['radius=0.01..0.2']\nminutes = 1.5\n");
    EXPECT_EQ(file.head.title, "T");
    EXPECT_EQ(file.head.scenes.front().name, "a");
    EXPECT_EQ(file.head.resolution, std::pair(8, 4));
    EXPECT_EQ(file.head.epsilon, 0.02);
    EXPECT_EQ(file.target, "5%");
    EXPECT_THAT(file.methods, ElementsAre("photon_mapper gather=100 cache=on", "path"));
    ASSERT_EQ(file.variations.size(), 1u);
    EXPECT_EQ(file.variations.front().text, "radius=0.01..0.2");
    EXPECT_EQ(file.variations.front().where.line, 8);
    EXPECT_EQ(file.minutes, 1.5);
}

TEST_F(TuneFileTest, HasTheDefaultsOfTheCommandLine) {
    const TuneFile file = parse("[tune]\nmethod = 'path'\n");
    EXPECT_EQ(file.target, "2%");
    EXPECT_THAT(file.methods, ElementsAre("path"));
    EXPECT_EQ(file.minutes, 20);
    EXPECT_EQ(parse("[tune]\ntarget = 0.05\n").target, "0.05");
    EXPECT_FALSE(parse_tune_file("scenes = ['a.xml']\n", folder_ / "e.toml"));
}

TEST_F(TuneFileTest, NamesThePlaceOfWhatIsWrong) {
    EXPECT_THAT(error_of("[tune]\ntargets = '5%'\n"),
                StartsWith("e.toml:3:1: unknown key 'targets' in tune; there are: target, method, vary, minutes"));
    EXPECT_THAT(error_of("[tune]\ntarget = '500%'\n"), StartsWith("e.toml:3:10: a target is a relative error"));
    EXPECT_THAT(error_of("[tune]\nminutes = 0\n"), StartsWith("e.toml:3:11: 'minutes' needs a number above 0"));
    EXPECT_THAT(error_of("[tune]\nmethod = ['path', 'paths']\n"), StartsWith("e.toml:3:19: "));
    EXPECT_THAT(error_of("[tune]\nmethod = 'photon_mapper cache=on'\n"), StartsWith("e.toml:3:10: "));
    EXPECT_THAT(error_of("[tune]\nmethod = 'photon_view'\n"), StartsWith("e.toml:3:10: "));
    EXPECT_THAT(error_of("[tune]\nvary = []\n"), StartsWith("e.toml:3:8: 'vary' needs a list of variations"));
    EXPECT_THAT(error_of("tune = 3\n"), StartsWith("e.toml:2:8: 'tune' needs a table"));
}

TEST_F(TuneFileTest, LeavesNoRoomForCells) {
    EXPECT_THAT(error_of("seeds = 3\n[tune]\n"),
                StartsWith("e.toml:2:1: unknown key 'seeds' in an experiment with [tune]"));
    EXPECT_THAT(error_of("[tune]\n[[method]]\nname = 'path'\n"), HasSubstr("unknown key 'method'"));
}

}  // namespace
}  // namespace gib::test::tune_file_test
