// The built program as a user meets it: exit codes, messages, files.

#include "common/images/image_file.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/source_path.h"

#include <gmock/gmock.h>

namespace gib::test::command_line_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class CommandLineTest : public ::testing::Test {
protected:
    CommandLineTest() { folder_.write("tiny.xml", tiny_scene_xml()); }
    ProgramResult run(const std::string& arguments) { return run_gibench(arguments, folder_ / ""); }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::recursive_directory_iterator(folder_ / ""), {}));
    }
    TemporaryFolder folder_;
};

TEST_F(CommandLineTest, HelpAndVersionSucceed) {
    EXPECT_EQ(run("--help").code, 0);
    EXPECT_THAT(run("--help").out, AllOf(HasSubstr("render"), Not(HasSubstr("measure-cell"))));
    EXPECT_THAT(run("--version").out,
                AllOf(StartsWith("gibench "), HasSubstr("\ncommit: "), HasSubstr("\ncompiler: "),
                      HasSubstr("\nbuild type: "), HasSubstr("-ffp-contract=off"), Not(HasSubstr("$<"))));
    EXPECT_THAT(run("render --help").out, AllOf(HasSubstr("photon_mapper"), HasSubstr("max_depth")));
}

TEST_F(CommandLineTest, WrongInputGivesTwoAndWritesNothing) {
    folder_.write("broken.xml", "<scene version='3.0.0'>\n<sensr/></scene>");
    folder_.write("e.toml", "scenes = ['tiny.xml']\n[[method]]\nname = 'path'\nspq = 3\n");
    const std::size_t before = files();
    for (const char* arguments : {"",
                                  "nonsense",
                                  "render",
                                  "render tiny.xml",
                                  "render tiny.xml --method path",
                                  "run",
                                  "run none.toml",
                                  "run e.toml",
                                  "render none.xml --method path -o a.exr",
                                  "render broken.xml --method path -o a.exr",
                                  "render tiny.xml --method pth -o a.exr",
                                  "render tiny.xml --method 'path spp=0' -o a.exr",
                                  "render tiny.xml --method path -o none/a.exr",
                                  "render tiny.xml --method path -o a.txt",
                                  "render tiny.xml --method path --threads 0 -o a.exr",
                                  "render tiny.xml --method path --seed -1 -o a.exr",
                                  "render tiny.xml --method path --set nothing -o a.exr",
                                  "render tiny.xml --method path --set unknown=1 -o a.exr",
                                  "render tiny.xml --method path --resolution 640 -o a.exr",
                                  "render tiny.xml --method path --resolution 0x4 -o a.exr",
                                  "render tiny.xml --method path --resolution 4x65537 -o a.exr",
                                  "plan tiny.xml --resolution 4x",
                                  "reference tiny.xml --target 0 -o a.exr",
                                  "reference tiny.xml --method 'path spp=4' -o a.exr",
                                  "reference tiny.xml --target 40% --max-seconds nan -o a.exr",
                                  "reference tiny.xml --target 40% --max-seconds inf -o a.exr",
                                  "reference tiny.xml --target 40% --max-seconds -1 -o a.exr",
                                  "reference tiny.xml --target 40% --max-seconds 0 -o a.exr",
                                  "compare tiny.xml",
                                  "compare a.exr b.exr",
                                  "plan none.xml",
                                  "plan tiny.xml --method pth",
                                  "list",
                                  "list things",
                                  "report none",
                                  "measure-cell none.json"}) {
        const ProgramResult result = run(arguments);
        EXPECT_EQ(result.code, 2) << arguments << "\n" << result.err;
        EXPECT_NE(result.err, "") << arguments;
        EXPECT_EQ(files(), before) << arguments;
    }
    EXPECT_THAT(run("run e.toml").err, HasSubstr("e.toml:4:1: "));
    EXPECT_THAT(run("render broken.xml --method path -o a.exr").err, HasSubstr("broken.xml:2:"));
    EXPECT_THAT(run("render tiny.xml --method pth -o a.exr").err, HasSubstr("photon_mapper"));
}

TEST_F(CommandLineTest, RenderWritesLayersAndMetadata) {
    const ProgramResult result = run("render tiny.xml --method 'path spp=3' --seed 7 --threads 1 -o a.exr");
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("seconds: "), HasSubstr("rays per second: ")));
    const LayeredImage image = read_image(folder_ / "a.exr");
    EXPECT_NE(image.find(""), nullptr);
    EXPECT_NE(image.find("direct"), nullptr);
    EXPECT_EQ(image.metadata.at("method"), "path spp=3");
    EXPECT_EQ(image.metadata.at("seed"), "7");
    EXPECT_EQ(image.metadata.at("passes"), "3");
    EXPECT_EQ(image.metadata.at("scene"), "tiny");
}

// The max_depth of a scene's integrator: -1 is unlimited; 0 edges show nothing, as in Mitsuba.
TEST_F(CommandLineTest, ResolutionReplacesTheFilmsSize) {
    ASSERT_EQ(run("render tiny.xml --method 'path spp=1' --resolution 6x3 -o a.exr").code, 0);
    ASSERT_EQ(run("reference tiny.xml --target 40% --resolution 6x3 -o r.exr").code, 0);
    for (const char* file : {"a.exr", "r.exr"}) {
        const LayeredImage image = read_image(folder_ / file);
        EXPECT_EQ(image.layers.front().second.width, 6) << file;
        EXPECT_EQ(image.layers.front().second.height, 3) << file;
    }
    EXPECT_EQ(run("plan tiny.xml --resolution 6x3").code, 0);
    EXPECT_THAT(run("render tiny.xml --method path --resolution 640 -o b.exr").err, HasSubstr("640x480"));
}

TEST_F(CommandLineTest, RenderSaysWhatAMethodLeavesOut) {
    const std::string glass =
        "render '" + source_path("scenes/cornell-glass.xml") + "' --resolution 4x4 -o a.exr --method ";
    EXPECT_THAT(run(glass + "'radiosity patch=0.3 spp=1'").err,
                AllOf(HasSubstr("warning: 'radiosity patch=0.3 spp=1' does not simulate"), HasSubstr("refraction"),
                      HasSubstr("leaves out light of the components: ")));
    EXPECT_THAT(run(glass + "'path spp=1'").err, Not(HasSubstr("warning")));
}

TEST_F(CommandLineTest, AMaxDepthOfZeroIsABlackImage) {
    std::string xml = tiny_scene_xml();
    xml.insert(xml.find("<sensor"), "<integrator type='path'><integer name='max_depth' value='0'/></integrator>");
    folder_.write("dark.xml", xml);
    for (const std::string method : {"path", "photon_mapper"}) {
        const ProgramResult result = run("render dark.xml --method '" + method + " spp=4' -o a.exr");
        ASSERT_EQ(result.code, 0) << result.err;
        const LayeredImage image = read_image(folder_ / "a.exr");
        ASSERT_NE(image.find("direct"), nullptr);
        for (const auto& [name, layer] : image.layers)
            EXPECT_THAT(layer.rgb, ::testing::Each(0.f)) << name;
    }
    ASSERT_EQ(run("render dark.xml --method 'path max_depth=0' -o a.exr").code, 0);
    EXPECT_THAT(read_image(folder_ / "a.exr").find("")->rgb, ::testing::Contains(::testing::Gt(0.f)))
        << "a method's own 0 is unlimited";
}

TEST_F(CommandLineTest, SameSeedGivesTheSamePixelsForAnyThreads) {
    ASSERT_EQ(run("render tiny.xml --method path --threads 1 -o a.exr").code, 0);
    ASSERT_EQ(run("render tiny.xml --method path --threads 3 -o b.exr").code, 0);
    ASSERT_EQ(run("render tiny.xml --method path --seed 2 -o c.exr").code, 0);
    const auto pixels = [&](const char* name) { return read_image(folder_ / name).find("")->rgb; };
    EXPECT_EQ(pixels("a.exr"), pixels("b.exr"));
    EXPECT_NE(pixels("a.exr"), pixels("c.exr"));
}

TEST_F(CommandLineTest, ReferenceIsMadeAndToppedUp) {
    ASSERT_EQ(run("reference tiny.xml --target 40% -o r.exr").code, 0);
    ASSERT_EQ(run("render tiny.xml --method path -o a.exr").code, 0);
    const ProgramResult compared = run("compare a.exr r.exr --json");
    EXPECT_EQ(compared.code, 0) << compared.err;
    EXPECT_THAT(compared.out, HasSubstr("\"rel_mse\""));
}

TEST_F(CommandLineTest, PlanSaysWhatRunsAndWhatIsSkipped) {
    const ProgramResult one = run("plan tiny.xml --method photon_mapper");
    ASSERT_EQ(one.code, 0) << one.err;
    EXPECT_THAT(one.out, AllOf(HasSubstr("called for: direct_light\n"), HasSubstr("runs: "), HasSubstr("skipped: "),
                               Not(HasSubstr("method: "))));
    EXPECT_THAT(run("plan tiny.xml").out, AllOf(HasSubstr("method: path\n"), HasSubstr("method: photon_mapper\n")));
}

// Files are found in the folders of -a, and of an experiment's `paths`; what was changed in an old scene is said.
TEST_F(CommandLineTest, SearchesFoldersAndWarns) {
    folder_.write("meshes/square.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    folder_.write(
        "old.xml",
        "<scene version='0.6.0'>\n<integrator type='bdpt'/>\n<sensor type='perspective'><film "
        "type='ldrfilm'><integer name='width' value='4'/><integer name='height' value='4'/></film></sensor><shape "
        "type='obj'><string name='filename' value='square.obj'/></shape><emitter type='constant'/></scene>");
    folder_.write("e.toml",
                  "scenes = ['old.xml']\npaths = ['meshes']\nbudget = { passes = 1 }\n[reference]\ntarget = "
                  "'60%'\n[[method]]\nname = 'path'\n");
    const std::string warning = "warning: old.xml:2:1: integrator 'bdpt'";
    EXPECT_EQ(run("plan old.xml").code, 2);
    EXPECT_THAT(run("plan old.xml -a nowhere -a meshes").out, StartsWith(warning));
    const ProgramResult rendered = run("render old.xml -a meshes --method 'path spp=1' -o a.exr");
    EXPECT_EQ(rendered.code, 0);
    EXPECT_THAT(rendered.err, HasSubstr(warning));
    const ProgramResult experiment = run("run e.toml --out r");
    EXPECT_EQ(experiment.code, 0);
    EXPECT_THAT(experiment.err, HasSubstr("old.xml:2:1: integrator 'bdpt'"));
}

TEST_F(CommandLineTest, PlanSaysWhatAMethodCannotSample) {
    const std::string glass = "plan '" + source_path("scenes/cornell-glass.xml") + "' --method ";
    EXPECT_THAT(run(glass + "light_tracer").out, HasSubstr("unresolved: caustic\n"));
    EXPECT_THAT(run(glass + "bidirectional").out, Not(HasSubstr("unresolved")));
}

TEST_F(CommandLineTest, NamesTheWrongWordAndTheLikelyRightOne) {
    const auto error = [&](const std::string& arguments) {
        const ProgramResult result = run(arguments);
        EXPECT_EQ(result.code, 2) << arguments;
        return result.err;
    };
    EXPECT_THAT(error("rendre tiny.xml"),
                StartsWith("gibench has no command 'rendre'; did you mean 'render'? There are: run, "));
    EXPECT_THAT(error(""), StartsWith("gibench needs a command; there are: run, "));
    EXPECT_THAT(error("list parameters"), StartsWith("gibench list has no command 'parameters'. There are: methods, "));
    EXPECT_THAT(error("list"), StartsWith("gibench list needs a command; there are: methods, scenes, effects"));
    EXPECT_THAT(
        error("render tiny.xml --method path spp=16 -o a.exr"),
        StartsWith("gibench render: 'spp=16' is not expected; a label stands in quotes: --method \"NAME spp=16\""));
    EXPECT_THAT(error("render tiny.xml --spp 4 --method path -o a.exr"),
                StartsWith("gibench render: '--spp' is not expected; parameters stand in the label"));
    EXPECT_THAT(error("run --seed 3 e.toml"),
                StartsWith("gibench run: '--seed' is not expected; did you mean '--seeds'?"));
    EXPECT_THAT(error("plan corner-box"), HasSubstr("did you mean 'cornell-box'?"));
    EXPECT_THAT(error("tune corner-box"), HasSubstr("did you mean 'cornell-box'?"));
    EXPECT_THAT(error("reference tiny.xml --target 1 -o a.exr"), HasSubstr("did you mean \"1%\"?"));
}

TEST_F(CommandLineTest, ScenesOfTheProgramAreKnownByName) {
    EXPECT_THAT(run("plan cornell-glass").out, HasSubstr("called for: refraction\n"));
    ASSERT_EQ(run("render furnace --method 'path spp=1' --resolution 2x2 -o a.exr").code, 0);
    EXPECT_EQ(read_image(folder_ / "a.exr").metadata.at("scene"), "furnace");
}

TEST_F(CommandLineTest, ExperimentsOfTheProgramAreKnownByName) {
    EXPECT_THAT(run("list experiments").out, HasSubstr("point-sets                   Sobol' points against"));
    EXPECT_THAT(run("run point-set").err, HasSubstr("did you mean 'point-sets'?"));
    const ProgramResult none = run("run point-sets --only nothing");
    EXPECT_EQ(none.code, 2);
    EXPECT_THAT(none.err, HasSubstr("--only 'nothing' keeps no cell"));
}

TEST_F(CommandLineTest, BashCompletesCommandsOptionsAndNames) {
    folder_.write("cornell.xml", tiny_scene_xml());
    const auto completed = [&](const std::string& words) {
        folder_.write("complete.sh", "source <('" + program_path() + "' completion bash)\nCOMP_WORDS=(gibench " +
                                         words +
                                         ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_gibench\n"
                                         "printf '%s ' \"${COMPREPLY[@]}\" >completed\n");
        EXPECT_EQ(std::system(("cd '" + (folder_ / "") + "' && bash complete.sh").c_str()), 0);
        return read_file(folder_ / "completed");
    };
    EXPECT_EQ(completed("re"), "render reference report ");
    EXPECT_EQ(completed("list sc"), "scenes ");
    EXPECT_EQ(completed("list methods --p"), "--parameters ");
    EXPECT_EQ(completed("compare --z-test --v"), "--variance ");
    EXPECT_EQ(completed("render --method pho"), "photon_mapper photon_view ");
    EXPECT_EQ(completed("render cornell"), "cornell-box cornell-glass cornell.xml ");
    EXPECT_EQ(completed("run --seeds 3 first"), "first-look ");
    EXPECT_EQ(completed("run --seeds first"), " ") << "the value of an option";
    EXPECT_THAT(completed("''"), Not(HasSubstr("measure-cell")));
}

TEST_F(CommandLineTest, ReferencesAreNeverLostToAnotherScene) {
    ASSERT_EQ(run("reference tiny.xml --target 40% -o r.exr").code, 0);
    folder_.write("other.xml", tiny_scene_xml(6));
    const std::string before = read_file(folder_ / "r.exr");
    for (const char* arguments :
         {"reference other.xml --target 40% -o r.exr", "reference tiny.xml --method path --target 40% -o r.exr",
          "reference tiny.xml --resolution 4x4 --target 40% -o r.exr",
          "render tiny.xml --method 'path spp=1' -o r.exr"}) {
        const ProgramResult result = run(arguments);
        EXPECT_EQ(result.code, 2) << arguments;
        EXPECT_THAT(result.err, StartsWith("r.exr:1:1: this is ")) << arguments;
        EXPECT_EQ(read_file(folder_ / "r.exr"), before) << arguments;
    }
    EXPECT_EQ(run("reference tiny.xml --target 39% -o r.exr").code, 0) << "its own scene adds to it";
    EXPECT_EQ(run("reference other.xml --target 40% --replace -o r.exr").code, 0);
    ASSERT_EQ(run("render tiny.xml --method 'path spp=1' -o a.exr").code, 0);
    EXPECT_EQ(run("reference tiny.xml --target 40% -o a.exr").code, 2) << "nor is an image";
}

TEST_F(CommandLineTest, ImagesOfDifferentScenesAreNotCompared) {
    ASSERT_EQ(run("reference tiny.xml --target 40% -o r.exr").code, 0);
    std::string xml = tiny_scene_xml();
    const std::size_t at = xml.find("value='5'/></emitter>");
    ASSERT_NE(at, std::string::npos);
    folder_.write("brighter.xml", xml.replace(at, 9, "value='6'"));
    ASSERT_EQ(run("render brighter.xml --method 'path spp=1' -o b.exr").code, 0);
    const ProgramResult refused = run("compare b.exr r.exr");
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("b.exr ('brighter') and r.exr ('tiny')"), HasSubstr("not of the same scene")));
    EXPECT_EQ(run("compare b.exr r.exr --other-scene").code, 0);
}

TEST_F(CommandLineTest, ASceneWithoutLightIsSaid) {
    std::string xml = tiny_scene_xml();
    const std::size_t begin = xml.find("<emitter"), end = xml.find("</emitter>") + 10;
    folder_.write("dark.xml", xml.erase(begin, end - begin));
    EXPECT_THAT(run("render dark.xml --method 'path spp=1' -o a.exr").err,
                HasSubstr("warning: nothing in the scene emits light"));
    EXPECT_THAT(run("plan dark.xml").out, HasSubstr("warning: nothing in the scene emits light"));
    EXPECT_THAT(run("plan tiny.xml").out, Not(HasSubstr("warning")));
}

// The old numbers are gone then, so that it is said.
TEST_F(CommandLineTest, ARunSaysWhichCellsAChangedSceneReplaces) {
    folder_.write("e.toml",
                  "scenes = ['tiny.xml']\nseeds = 2\nbudget = { passes = 1 }\n[reference]\ntarget = '60%'\n"
                  "[[method]]\nname = 'path'\n");
    EXPECT_THAT(run("run e.toml --out r").err, Not(HasSubstr("done again")));
    folder_.write("tiny.xml", tiny_scene_xml(9));
    EXPECT_THAT(run("run e.toml --out r").err, HasSubstr("done again: 2"));
    EXPECT_THAT(run("run e.toml --out r").err, HasSubstr("cells complete already, not done again: 2"));
}

TEST_F(CommandLineTest, HelpOfRunHasTheKeysOfAnExperimentFile) {
    const std::string help = run("run --help").out;
    for (const char* key : {"title", "scenes", "paths", "resolution", "seeds", "epsilon", "budget", "[reference]",
                            "target", "seconds", "[[method]]", "name"})
        EXPECT_THAT(help, HasSubstr(key));
}

TEST_F(CommandLineTest, ListsNameFirst) {
    EXPECT_THAT(run("list methods").out, AllOf(StartsWith("path "), HasSubstr("\nphoton_mapper ")));
    EXPECT_THAT(run("list methods --parameters").out, AllOf(HasSubstr("  photons"), HasSubstr("  spp")));
    EXPECT_THAT(run("list effects").out, StartsWith("direct_light "));
    EXPECT_THAT(run("list scenes").out, HasSubstr("cornell-box "));
}

}  // namespace
}  // namespace gib::test::command_line_test
