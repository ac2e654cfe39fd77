// Experiment files: their meaning, and the messages about wrong ones; [[method]] tables with a command, and [tune].

#include "experiments/plan/experiment_file.h"

#include "experiments/plan/experiment_keys.h"
#include "experiments/system/shipped_files.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/input_error.h"

namespace gib::test::experiment_file_test {
namespace {

class ExperimentFileTest : public ::testing::Test {
protected:
    ExperimentFileTest() {
        for (const char* scene : {"a.xml", "b.xml"})
            folder_.write(scene, "<scene/>");
        folder_.write("r.exr", "");
        folder_.write("s.exr", "");
    }
    Experiment parse(const std::string& text) const { return parse_experiment(text, folder_ / "e.toml"); }
    std::string error_of(const std::string& text) const {
        return input_error_in("e.toml", [&] { parse(text); });
    }
    static std::vector<std::string> texts_of(const Experiment& experiment) {
        std::vector<std::string> texts;
        for (const auto& label : experiment.methods)
            texts.push_back(label.text());
        return texts;
    }
    std::vector<std::string> labels(const std::string& methods) const {
        return texts_of(parse("scenes = ['a.xml']\n" + methods));
    }
    TemporaryFolder folder_;
};

TEST_F(ExperimentFileTest, LabelsKeepTheOrderAndTheNumbersAsTyped) {
    EXPECT_THAT(labels("[[method]]\nname = 'photon_mapper'\nspp = 4\nphotons = 1e4\nk = 50\nradius = 0.10\n"),
                ElementsAre("photon_mapper spp=4 photons=1e4 k=50 radius=0.10"));
}

TEST_F(ExperimentFileTest, ScenesAreFilesOrNamesOfScenesThatComeWithTheProgram) {
    const auto scenes = [&](const std::string& names) {
        return parse("scenes = [" + names + "]\n[[method]]\nname = 'path'\n").scenes;
    };
    const ExperimentScene box = scenes("'cornell-box', 'a.xml'").front();
    EXPECT_EQ(box.path, scene_file("cornell-box"));
    EXPECT_EQ(box.name, "cornell-box");
    folder_.write("cornell-box", "<scene/>");
    EXPECT_EQ(scenes("'cornell-box'").front().path, folder_ / "cornell-box") << "files come first";
    const std::string rest = "[[method]]\nname = 'path'\n";
    EXPECT_THAT(error_of("scenes = ['cornel-box']\n" + rest),
                AllOf(HasSubstr("e.toml:1:11: there is no scene file"), HasSubstr("did you mean 'cornell-box'?")));
    EXPECT_THAT(error_of("scenes = ['x/cornell-box']\n" + rest), HasSubstr("no scene of that name"));
    EXPECT_THAT(error_of("scenes = ['cornell-box', 'cornell-box']\n" + rest),
                HasSubstr("two scenes are named 'cornell-box'"));
}

TEST_F(ExperimentFileTest, AMethodTakesANameForItsRows) {
    const Experiment e = parse("scenes = ['a.xml']\n[[method]]\nname = 'path'\nlabel = 'paths'\nspp = [4, 8]\n");
    EXPECT_THAT(texts_of(e), ElementsAre("path spp=4", "path spp=8")) << "keys of cells do not depend on it";
    EXPECT_EQ(e.given_names, (std::map<std::string, std::string>{{"path spp=4", "paths"}, {"path spp=8", "paths"}}));
    const std::string head = "scenes = ['a.xml']\n[[method]]\nname = 'path'\n";
    EXPECT_THAT(error_of(head + "label = 'x'\n[[method]]\nname = 'vcm'\nlabel = 'x'\n"),
                HasSubstr("two methods have the label 'x'"));
    EXPECT_THAT(error_of(head + "label = ''\n"), HasSubstr("'label' needs a text"));
    EXPECT_THAT(error_of(head + "label = 3\n"), HasSubstr("label"));
}

TEST_F(ExperimentFileTest, AFilterHasTheNameOfItsProgram) {
    for (const auto& [command, name] : {std::pair("./tools/denoise.sh", "denoise.sh"),
                                        {"'/opt/my tools/denoise.sh'", "denoise.sh"},
                                        {"\\\"/opt/my tools/denoise.sh\\\"", "denoise.sh"},
                                        {"/opt/my\\\\ tools/denoise.sh", "denoise.sh"},
                                        {"'./my denoiser'", "my_denoiser"}})
        EXPECT_THAT(labels("[[method]]\nname = 'path'\nfilter = \"" + std::string(command) + " {image} {out}\"\n"),
                    ElementsAre("path filter=" + std::string(name)))
            << command;
}

TEST_F(ExperimentFileTest, AKeyOfTheWholeFileInATableIsToldItsPlace) {
    const std::string head = "scenes = ['a.xml']\n[[method]]\nname = 'path'\n", place = "above the first [[method]]";
    EXPECT_THAT(error_of(head + "resolution = [4, 4]\n"), AllOf(HasSubstr("e.toml:4:1: "), HasSubstr(place)));
    EXPECT_THAT(error_of("scenes = ['a.xml']\n[[method]]\nname = 'x'\ncommand = 'x {scene} {out}'\nseeds = 2\n"),
                HasSubstr(place));
    EXPECT_THAT(error_of("scenes = ['a.xml']\n[budget]\npasses = 4\nseeds = 2\n"), HasSubstr(place));
    EXPECT_THAT(error_of(head + "spq = 4\n"), AllOf(HasSubstr("did you mean 'spp'?"), Not(HasSubstr(place))));
    EXPECT_THAT(error_of("sedes = 2\n" + head), HasSubstr("did you mean 'seeds'?"));
}

TEST_F(ExperimentFileTest, ListsMakeSweepsAndGrids) {
    EXPECT_THAT(labels("[[method]]\nname = 'path'\nspp = [16, 64, 2_56] # three\n"),
                ElementsAre("path spp=16", "path spp=64", "path spp=256"));
    EXPECT_THAT(labels("[[method]]\nname = 'photon_mapper'\nphotons = [\n  1e4,\n  1E5\n]\nk = [20, 50]\n"),
                ElementsAre("photon_mapper photons=1e4 k=20", "photon_mapper photons=1e4 k=50",
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

// A key that is declared but not read would be ignored in silence.
TEST_F(ExperimentFileTest, ReadsEveryDeclaredKey) {
    for (const auto& table : experiment_keys())
        for (const auto& [key, value, sentence] : table.entries) {
            std::string text = key == "scenes" ? "" : "scenes = ['a.xml']\n";
            if (table.name[0] == '[') text += table.name.substr(0, table.name.find(' ')) + "\n";
            if (table.name.find("command") != std::string::npos)
                for (const std::string given : {"name = 'x'\n", "command = 'r {scene} {out}'\n"})
                    if (!given.starts_with(key)) text += given;
            text += key + " = [true]\n";
            const auto read = [&] { return parse_tune_file(text, folder_ / "e.toml") || parse(text).seeds > 0; };
            EXPECT_THAT(test::input_error_of(read), HasSubstr(": '" + key + "' needs ")) << text;
        }
}

TEST_F(ExperimentFileTest, ErrorsSayTheirPlaceAndWhatIsKnown) {
    const std::string start = "scenes = ['a.xml']\n", path = "[[method]]\nname = 'path'\n";
    const std::vector<std::array<std::string, 3>> cases = {
        // the file, where its error stands, and what it names
        {start + "sedes = 3\n" + path, "2:1: ", "seeds"},
        {start + "paths = ['none']\n" + path, "2:10: ", "there is no folder '" + (folder_ / "none") + "'"},
        {start + "seeds = 'x'\n" + path, "2:9: ", ""},
        {start + "resolution = [65536, 65536]\n" + path, "2:14: ", "above 1e+09 pixels"},
        {start + "epsilon = 1e-310\n" + path, "2:11: ", "from 1e-60 to 1e+60, not 1e-310"},
        {"scenes = ['no.xml']\n" + path, "1:11: ", "no.xml"},
        {start + "[[method]]\nname = 'pth'\n", "3:8: ", "photon_mapper"},
        {start + path + "photons = 3\n", "4:1: ", "max_depth"},
        {start + path + "spp = [16, -1]\n", "4:12: ", "out of range"},
        {start + path + "spp = []\n", "4:7: ", ""},
        {start + path + path, "", "twice"},
        {start + "[[method]]\nspp = 3\n", "", "'name'"},
        {start + "[reference]\ntarget = 'tiny'\n" + path, "3:10: ", ""},
        {start + "[reference]\ntarget = ['1%', '2%']\n" + path, "", "2 values for 1 scenes"},
        {start + "[reference]\nmethod = 'path spp=4'\n" + path, "", "spp"},
        {start + "budget = { minutes = 3 }\n" + path, "2:12: ", "seconds"},
        {"scenes = [\n", "", ""},
        {start, "", "[[method]]"},
        {path, "", "scenes"}};
    for (const auto& [text, place, named] : cases)
        EXPECT_THAT(error_of(text), AllOf(StartsWith("e.toml:" + place), HasSubstr(named))) << text;
}

TEST_F(ExperimentFileTest, AByteOrderMarkIsNoPartOfTheFirstLine) {
    const std::string mark = "\xef\xbb\xbf", method = "\n[[method]]\nname = 'path'\n";
    const Experiment e = parse(mark + "reference = { target = 0.1 }\nscenes = ['a.xml']" + method);
    EXPECT_DOUBLE_EQ(e.scenes[0].goal.target.value(), 0.1);
    EXPECT_THAT(error_of(mark + "scenes = ['no.xml']" + method), StartsWith("e.toml:1:11: "));
}

TEST_F(ExperimentFileTest, ColumnsCountCharactersNotBytes) {
    EXPECT_THAT(labels("[[method]]\nname = 'photon_mapper' # \xc3\xbc\nphotons = [ 1e4, 1e5 ] # \xc3\xbc\n"),
                ElementsAre("photon_mapper photons=1e4", "photon_mapper photons=1e5"));
}

TEST(ParseTarget, TakesPercentAndFraction) {
    EXPECT_DOUBLE_EQ(parse_target("0.5%"), 0.005);
    EXPECT_DOUBLE_EQ(parse_target("0.02"), 0.02);
    for (const char* wrong : {"", "%", "0", "-1%", "100%", "1 %%", "nan"})
        EXPECT_THROW(parse_target(wrong), InputError) << wrong;
}

TEST(ShippedExperiments, AreValid) {
    for (const auto& file : std::filesystem::directory_iterator(source_path("experiments"))) {
        if (file.path().extension() != ".toml") continue;
        EXPECT_NO_THROW({
            if (!load_tune_file(file.path().string())) load_experiment(file.path().string());
        }) << file.path();
    }
}

/// Line 2 is the name, line 3 the command.
class ExternalMethodTest : public ExperimentFileTest {
protected:
    static std::string text(const std::string& command, const std::string& more, const std::string& name) {
        return "scenes = ['a.xml']\n[[method]]\nname = '" + name + "'\ncommand = '" + command + "'\n" + more;
    }
    Experiment parse(const std::string& command, const std::string& more = "") const {
        return ExperimentFileTest::parse(text(command, more, "other"));
    }
    std::string error_of(const std::string& command, const std::string& more = "", const std::string& name = "other") {
        return ExperimentFileTest::error_of(text(command, more, name));
    }
};

TEST_F(ExternalMethodTest, KeysOfItsOwnMakeASweep) {
    const Experiment e = parse("x {scene} {out} {spp} {mode}", "spp = [4, 16]\nmode = ['fast', 'slow']\n");
    EXPECT_THAT(texts_of(e), ElementsAre("other spp=4 mode=fast", "other spp=4 mode=slow", "other spp=16 mode=fast",
                                         "other spp=16 mode=slow"));
    const ExternalMethod* external = e.external(e.methods[3]);
    ASSERT_TRUE(external);
    EXPECT_EQ(external->spp, 16u);
    EXPECT_EQ(filled_command(*external, {{"scene", "s"}, {"out", "o"}, {"spp", "16"}}), "x s o 16 slow");
}

TEST_F(ExternalMethodTest, ValuesAreQuotedForTheShell) {
    const Experiment e = parse("x {scene} {out} ${HOME} {} {A}");
    EXPECT_EQ(filled_command(*e.external(e.methods[0]), {{"scene", "a b'c"}, {"out", "/o.exr"}}),
              "x 'a b'\\''c' /o.exr ${HOME} {} {A}");
}

TEST_F(ExternalMethodTest, MessagesNameThePlaceAndWhatThereIs) {
    for (const auto& [command, error] :
         {std::pair{"x {out}", "e.toml:4:11: a command needs the placeholder {scene}"},
          {"x {scene}", "a command needs the placeholder {out}"},
          {"x {scene} {out} {mode}", "e.toml:4:11: the placeholder {mode} has no value"},
          {"x {scene} {out} {seconds}", "e.toml:4:11: a command with {seconds} needs a budget"}})
        EXPECT_THAT(error_of(command), HasSubstr(error)) << command;
    for (const auto& [placeholders, keys, error] :
         {std::tuple{"", "mode = 3\n", "e.toml:5:1: unknown key 'mode'"},
          {"", "spp = 3\n", "e.toml:5:1: 'spp' has no effect: the command lacks the placeholder {spp}"},
          {"{seed}", "seed = 3\n", "e.toml:5:1: unknown key 'seed'"},
          {"{spp}", "spp = 0\n", "e.toml:5:7: parameter 'spp' = 0 is out of range"},
          {"{m}", "m = 'a b'\n", "e.toml:2:1: "},
          {"", "timeout = 0\n", "'timeout' needs a number above 0"},
          {"", "[[method]]\nname = 'other'\ncommand = 'y {scene} {out}'\n", "the method 'other' is listed twice"}})
        EXPECT_THAT(error_of(std::string("x {scene} {out} ") + placeholders, keys), HasSubstr(error)) << keys;
    EXPECT_THAT(error_of("x {scene} {out}", "", "path"), HasSubstr("e.toml:3:8: 'path' is a method of gibench"));
    EXPECT_THAT(error_of("x {scene} {out}", "", "a b"), HasSubstr("e.toml:3:8: "));
}

TEST_F(ExternalMethodTest, ReferenceImagesAreOneForEachScene) {
    const auto parse_reference = [&](const std::string& scenes, const std::string& reference) {
        return ExperimentFileTest::parse("scenes = " + scenes + "\n[reference]\n" + reference +
                                         "\n[[method]]\nname = 'path'\n");
    };
    EXPECT_EQ(parse_reference("['a.xml']", "image = 'r.exr'").scenes[0].reference_image, folder_ / "r.exr");
    EXPECT_EQ(parse_reference("['a.xml', 'b.xml']", "image = ['r.exr', 'r.exr']").scenes[1].reference_image,
              folder_ / "r.exr");
    EXPECT_EQ(parse_reference("['a.xml']", "target = '1%'").scenes[0].reference_image, "");
    for (const char* replicates : {"['a.xml']|['r.exr', 's.exr']", "['a.xml']|[['r.exr', 's.exr']]",
                                   "['a.xml', 'b.xml']|[['r.exr', 's.exr'], 'r.exr']"}) {
        const std::string text = replicates;
        const std::size_t bar = text.find('|');
        const auto scenes = parse_reference(text.substr(0, bar), "image = " + text.substr(bar + 1)).scenes;
        EXPECT_EQ(scenes[0].reference_image, folder_ / "r.exr");
        EXPECT_THAT(scenes[0].reference_replicates, ElementsAre(folder_ / "s.exr"));
        EXPECT_EQ(scenes.back().reference_replicates.size(), scenes.size() == 1 ? 1u : 0u);
    }
    const auto error = [&](const std::string& scenes, const std::string& reference) {
        return input_error_of([&] { parse_reference(scenes, reference); });
    };
    EXPECT_THAT(error("['a.xml', 'b.xml']", "image = 'r.exr'"),
                HasSubstr("e.toml:3:9: 'image' gives 1 references for 2 scenes"));
    EXPECT_THAT(error("['a.xml']", "image = 'none.exr'"), HasSubstr("e.toml:3:9: there is no image '"));
    EXPECT_THAT(error("['a.xml']", "image = 'r.exr'\ntarget = '1%'"), HasSubstr("e.toml:4:1: unknown key 'target'"));
}

class TuneFileTest : public ExperimentFileTest {
protected:
    TuneFile parse(const std::string& text) const {
        return parse_tune_file("scenes = ['a.xml']\n" + text, folder_ / "e.toml").value();
    }
    std::string error_of(const std::string& text) const {
        return input_error_in("e.toml", [&] { parse(text); });
    }
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

TEST_F(TuneFileTest, NamesThePlaceOfWhatIsWrong) {
    for (const auto& [text, error] :
         {std::pair{
              "[tune]\ntargets = '5%'\n",
              "3:1: unknown key 'targets' in tune; did you mean 'target'? There are: target, method, vary, minutes"},
          {"[tune]\ntarget = '500%'\n", "3:10: a target is a relative error"},
          {"[tune]\nminutes = 0\n", "3:11: 'minutes' needs a number above 0"},
          {"[tune]\nmethod = ['path', 'paths']\n", "3:19: "},
          {"[tune]\nmethod = 'photon_mapper cache=on'\n", "3:10: "},
          {"[tune]\nmethod = 'photon_view'\n", "3:10: "},
          {"[tune]\nvary = []\n", "3:8: 'vary' needs a list of variations"},
          {"tune = 3\n", "2:8: 'tune' needs a table"}})
        EXPECT_THAT(error_of(text), StartsWith(std::string("e.toml:") + error)) << text;
}

TEST_F(TuneFileTest, LeavesNoRoomForCells) {
    EXPECT_THAT(error_of("seeds = 3\n[tune]\n"),
                StartsWith("e.toml:2:1: unknown key 'seeds' in an experiment with [tune]"));
    EXPECT_THAT(error_of("[tune]\n[[method]]\nname = 'path'\n"), HasSubstr("unknown key 'method'"));
}

}  // namespace
}  // namespace gib::test::experiment_file_test
