// Experiment files: their meaning, and the messages about wrong ones.

#include "experiments/plan/experiment_file.h"

#include "experiments/plan/tune_file.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/input_error.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace gib::test::experiment_file_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ExperimentFileTest : public ::testing::Test {
protected:
    ExperimentFileTest() {
        folder_.write("a.xml", "<scene/>");
        folder_.write("b.xml", "<scene/>");
    }
    Experiment parse(const std::string& text) { return parse_experiment(text, folder_ / "e.toml"); }
    std::string error_of(const std::string& text) {
        const std::string what = test::input_error_of([&] { parse(text); });
        const std::size_t place = what.find("e.toml");
        return place == std::string::npos ? what : what.substr(place);
    }
    std::vector<std::string> labels(const std::string& methods) {
        std::vector<std::string> texts;
        for (const auto& label : parse("scenes = ['a.xml']\n" + methods).methods)
            texts.push_back(label.text());
        return texts;
    }
    TemporaryFolder folder_;
};

TEST_F(ExperimentFileTest, LabelsKeepTheOrderAndTheNumbersAsTyped) {
    EXPECT_THAT(labels("[[method]]\nname = 'photon_mapper'\nspp = 4\nphotons = 1e4\nk = 50\nradius = 0.10\n"),
                ::testing::ElementsAre("photon_mapper spp=4 photons=1e4 k=50 radius=0.10"));
}

TEST_F(ExperimentFileTest, ListsMakeSweepsAndGrids) {
    EXPECT_THAT(labels("[[method]]\nname = 'path'\nspp = [16, 64, 2_56] # three\n"),
                ::testing::ElementsAre("path spp=16", "path spp=64", "path spp=256"));
    EXPECT_THAT(labels("[[method]]\nname = 'photon_mapper'\nphotons = [\n  1e4,\n  1E5\n]\nk = [20, 50]\n"),
                ::testing::ElementsAre("photon_mapper photons=1e4 k=20", "photon_mapper photons=1e4 k=50",
                                       "photon_mapper photons=1E5 k=20", "photon_mapper photons=1E5 k=50"));
}

TEST_F(ExperimentFileTest, ReadsEveryKey) {
    const Experiment e = parse(
        "title = 'T'\nscenes = ['a.xml', 'b.xml']\nresolution = [32, 16]\nseeds = 5\nepsilon = 0.02\n"
        "budget = { seconds = 1.5, passes = 64 }\n[reference]\nmethod = 'path max_depth=9'\ntarget = ['1%', '0.5 %']\n"
        "seconds = 60\n[[method]]\nname = 'path'\n");
    EXPECT_EQ(e.title, "T");
    ASSERT_EQ(e.scenes.size(), 2u);
    EXPECT_EQ(e.scenes[1].name, "b");
    EXPECT_EQ(e.scenes[1].path, folder_ / "b.xml");
    EXPECT_EQ(e.resolution, std::make_pair(32, 16));
    EXPECT_EQ(e.seeds, 5);
    EXPECT_EQ(e.epsilon, 0.02);
    EXPECT_EQ(e.budget.seconds, 1.5);
    EXPECT_EQ(e.budget.passes, 64u);
    EXPECT_EQ(e.reference_method.text(), "path max_depth=9");
    EXPECT_DOUBLE_EQ(*e.scenes[0].goal.target, 0.01);
    EXPECT_DOUBLE_EQ(*e.scenes[1].goal.target, 0.005);
    EXPECT_EQ(e.scenes[1].goal.seconds, 60);
}

TEST_F(ExperimentFileTest, DefaultsHold) {
    const Experiment e = parse("scenes = ['a.xml']\n[[method]]\nname = 'path'\n");
    EXPECT_FALSE(e.epsilon) << "relative to each reference";
    EXPECT_EQ(e.seeds, 1);
    EXPECT_EQ(e.name, "e");
    EXPECT_EQ(e.reference_method.text(), "auto");
    EXPECT_EQ(e.scenes[0].goal.target, 0.01);
    EXPECT_FALSE(e.scenes[0].goal.seconds);
}

TEST_F(ExperimentFileTest, ErrorsSayTheirPlaceAndWhatIsKnown) {
    const std::string start = "scenes = ['a.xml']\n";
    const std::string path = "[[method]]\nname = 'path'\n";
    EXPECT_THAT(error_of(start + "sedes = 3\n" + path),
                AllOf(StartsWith("e.toml:2:1: "), HasSubstr("sedes"), HasSubstr("seeds")));
    EXPECT_THAT(error_of(start + "paths = ['none']\n" + path),
                AllOf(StartsWith("e.toml:2:10: "), HasSubstr("there is no folder '" + (folder_ / "none") + "'")));
    EXPECT_THAT(error_of(start + "seeds = 'x'\n" + path), StartsWith("e.toml:2:9: "));
    EXPECT_THAT(error_of(start + "seeds = 0\n" + path), StartsWith("e.toml:2:9: "));
    EXPECT_THAT(error_of(start + "epsilon = 1e-310\n" + path),
                AllOf(StartsWith("e.toml:2:11: "), HasSubstr("from 1e-60 to 1e+60, not 1e-310")));
    EXPECT_THAT(error_of("scenes = ['no.xml']\n" + path), AllOf(StartsWith("e.toml:1:11: "), HasSubstr("no.xml")));
    EXPECT_THAT(error_of(start + "[[method]]\nname = 'pth'\n"),
                AllOf(StartsWith("e.toml:3:8: "), HasSubstr("photon_mapper")));
    EXPECT_THAT(error_of(start + path + "photons = 3\n"), AllOf(StartsWith("e.toml:4:1: "), HasSubstr("max_depth")));
    EXPECT_THAT(error_of(start + path + "spp = [16, -1]\n"),
                AllOf(StartsWith("e.toml:4:12: "), HasSubstr("out of range")));
    EXPECT_THAT(error_of(start + path + "spp = '16'\n"), StartsWith("e.toml:4:7: "));
    EXPECT_THAT(error_of(start + path + "spp = 1.5\n"), StartsWith("e.toml:4:7: "));
    EXPECT_THAT(error_of(start + path + "spp = []\n"), StartsWith("e.toml:4:7: "));
    EXPECT_THAT(error_of(start + path + path), HasSubstr("twice"));
    EXPECT_THAT(error_of(start + "[[method]]\nspp = 3\n"), HasSubstr("'name'"));
    EXPECT_THAT(error_of(start + "[reference]\ntarget = 'tiny'\n" + path), StartsWith("e.toml:3:10: "));
    EXPECT_THAT(error_of(start + "[reference]\ntarget = ['1%', '2%']\n" + path), HasSubstr("2 values for 1 scenes"));
    EXPECT_THAT(error_of(start + "[reference]\nmethod = 'path spp=4'\n" + path), HasSubstr("spp"));
    EXPECT_THAT(error_of(start + "budget = { minutes = 3 }\n" + path),
                AllOf(StartsWith("e.toml:2:12: "), HasSubstr("seconds")));
    EXPECT_THAT(error_of("scenes = [\n"), StartsWith("e.toml:"));
    EXPECT_THAT(error_of(start), HasSubstr("[[method]]"));
    EXPECT_THAT(error_of(path), HasSubstr("scenes"));
}

TEST_F(ExperimentFileTest, AByteOrderMarkIsNoPartOfTheFirstLine) {
    const std::string mark = "\xef\xbb\xbf", method = "\n[[method]]\nname = 'path'\n";
    const Experiment e = parse(mark + "reference = { target = 0.1 }\nscenes = ['a.xml']" + method);
    EXPECT_DOUBLE_EQ(e.scenes[0].goal.target.value(), 0.1);
    EXPECT_THAT(error_of(mark + "scenes = ['no.xml']" + method), StartsWith("e.toml:1:11: "));
}

TEST_F(ExperimentFileTest, ColumnsCountCharactersNotBytes) {
    EXPECT_THAT(labels("[[method]]\nname = 'photon_mapper' # \xc3\xbc\nphotons = [ 1e4, 1e5 ] # \xc3\xbc\n"),
                ::testing::ElementsAre("photon_mapper photons=1e4", "photon_mapper photons=1e5"));
}

TEST(ParseTarget, TakesPercentAndFraction) {
    EXPECT_DOUBLE_EQ(parse_target("0.5%"), 0.005);
    EXPECT_DOUBLE_EQ(parse_target("0.02"), 0.02);
    for (const char* wrong : {"", "%", "0", "-1%", "100%", "1 %%", "nan"})
        EXPECT_THROW(parse_target(wrong), InputError) << wrong;
}

TEST(ShippedExperiments, AreValid) {
    for (const auto& file : std::filesystem::directory_iterator(test::source_path("experiments"))) {
        if (file.path().extension() != ".toml") continue;
        EXPECT_NO_THROW({
            if (!load_tune_file(file.path().string())) load_experiment(file.path().string());
        }) << file.path();
    }
}

}  // namespace
}  // namespace gib::test::experiment_file_test
