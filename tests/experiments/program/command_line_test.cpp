// The built program as a user meets it: exit codes, messages, files.

#include "common/images/image_file.h"
#include "tests/support/run_fixtures.h"
#include "tests/support/source_path.h"

namespace gib::test::command_line_test {
namespace {

class CommandLineTest : public ::testing::Test {
protected:
    CommandLineTest() { folder_.write("tiny.xml", tiny_scene_xml()); }
    ProgramResult run(const std::string& arguments) const { return run_gibench(arguments, folder_ / ""); }
    /// `gibench render SCENE --method METHOD -o a.exr`.
    ProgramResult render(const std::string& scene, const std::string& method) const {
        return run("render " + scene + " --method '" + method + "' -o a.exr");
    }
    LayeredImage image(const std::string& name = "a.exr") const { return read_image(folder_ / name); }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::recursive_directory_iterator(folder_ / ""), {}));
    }
    TemporaryFolder folder_;
};

TEST_F(CommandLineTest, WrongInputGivesTwoAndWritesNothing) {
    folder_.write("broken.xml", "<scene version='3.0.0'>\n<sensr/></scene>");
    folder_.write("e.toml", "scenes = ['tiny.xml']\n[[method]]\nname = 'path'\nspq = 3\n");
    const std::size_t before = files();
    const auto refused = [&](const std::string& arguments) {
        EXPECT_THAT(run(arguments), exits(2, Not(""))) << arguments;
        EXPECT_EQ(files(), before) << arguments;
    };
    for (const char* arguments :
         {"", "nonsense", "render tiny.xml --method path", "run none.toml", "run e.toml",
          "render none.xml --method path -o a.exr", "render broken.xml --method path -o a.exr",
          "render tiny.xml --method path -o none/a.exr", "render tiny.xml --method path -o a.txt",
          "compare a.exr b.exr", "plan none.xml", "plan tiny.xml --method pth", "plan tiny.xml --resolution 4x",
          "report none", "measure-cell none.json"})
        refused(arguments);
    for (const std::string method :
         {"pth", "'path spp=0'", "path --threads 0", "path --seed -1", "path --set nothing", "path --set unknown=1",
          "path --resolution 640", "path --resolution 0x4", "path --resolution 4x65537"})
        refused("render tiny.xml --method " + method + " -o a.exr");
    for (const std::string option :
         {"--target 0", "--method 'path spp=4'", "--target 40% --max-seconds nan", "--target 40% --max-seconds inf",
          "--target 40% --max-seconds -1", "--target 40% --max-seconds 0"})
        refused("reference tiny.xml " + option + " -o a.exr");
    EXPECT_THAT(run("run e.toml").err, HasSubstr("e.toml:4:1: "));
    EXPECT_THAT(render("broken.xml", "path").err, HasSubstr("broken.xml:2:"));
    EXPECT_THAT(render("tiny.xml", "pth").err, HasSubstr("photon_mapper"));
}

TEST_F(CommandLineTest, RenderWritesLayersAndMetadata) {
    EXPECT_THAT(run("render tiny.xml --method 'path spp=3' --seed 7 --threads 1 -o a.exr"),
                prints(HasSubstr("seconds: "), HasSubstr("rays per second: ")));
    EXPECT_NE(image().find(""), nullptr);
    EXPECT_NE(image().find("direct"), nullptr);
    for (const auto& [key, value] : std::map<std::string, std::string>{
             {"method", "path spp=3"}, {"seed", "7"}, {"passes", "3"}, {"scene", "tiny"}})
        EXPECT_EQ(image().metadata.at(key), value);
}

TEST_F(CommandLineTest, ResolutionReplacesTheFilmsSize) {
    ASSERT_EQ(run("render tiny.xml --method 'path spp=1' --resolution 6x3 -o a.exr").code, 0);
    ASSERT_EQ(run("reference tiny.xml --target 40% --resolution 6x3 -o r.exr").code, 0);
    for (const char* file : {"a.exr", "r.exr"}) {
        EXPECT_EQ(image(file).layers.front().second.width, 6) << file;
        EXPECT_EQ(image(file).layers.front().second.height, 3) << file;
    }
    EXPECT_EQ(run("plan tiny.xml --resolution 6x3").code, 0);
    EXPECT_THAT(run("render tiny.xml --method path --resolution 640 -o b.exr").err, HasSubstr("640x480"));
}

TEST_F(CommandLineTest, RenderSaysWhatAMethodLeavesOut) {
    const std::string glass = "'" + source_path("scenes/cornell-glass.xml") + "' --resolution 4x4";
    EXPECT_THAT(render(glass, "radiosity patch=0.3 spp=1").err,
                AllOf(HasSubstr("warning: 'radiosity patch=0.3 spp=1' does not simulate"), HasSubstr("refraction"),
                      HasSubstr("leaves out light of the components: ")));
    EXPECT_THAT(render(glass, "path spp=1").err, Not(HasSubstr("warning")));
}

// The max_depth of a scene's integrator: -1 is unlimited; 0 edges show nothing, as in Mitsuba.
TEST_F(CommandLineTest, AMaxDepthOfZeroIsABlackImage) {
    std::string xml = tiny_scene_xml();
    xml.insert(xml.find("<sensor"), element("integrator", "path", integer("max_depth", 0)));
    folder_.write("dark.xml", xml);
    for (const char* method : {"path spp=4", "photon_mapper spp=4"}) {
        ASSERT_THAT(render("dark.xml", method), exits(0));
        ASSERT_NE(image().find("direct"), nullptr);
        for (const auto& [name, layer] : image().layers)
            EXPECT_THAT(layer.rgb, Each(0.f)) << name;
    }
    ASSERT_EQ(render("dark.xml", "path max_depth=0").code, 0);
    EXPECT_THAT(image().find("")->rgb, Contains(::testing::Gt(0.f))) << "a method's own 0 is unlimited";
}

TEST_F(CommandLineTest, PlanSaysWhatRunsAndWhatIsSkipped) {
    EXPECT_THAT(run("plan tiny.xml --method photon_mapper"),
                prints(HasSubstr("called for: direct_light\n"), HasSubstr("runs: "), HasSubstr("skipped: "),
                       Not(HasSubstr("method: "))));
    EXPECT_THAT(run("plan tiny.xml").out,
                AllOf(HasSubstr("\n\nmethod: path\n"), HasSubstr("\n\nmethod: photon_mapper\n")));
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
    EXPECT_THAT(render("old.xml -a meshes", "path spp=1"), exits(0, HasSubstr(warning)));
    EXPECT_THAT(run("run e.toml --out r"), exits(0, HasSubstr("old.xml:2:1: integrator 'bdpt'")));
}

TEST_F(CommandLineTest, PlanSaysWhatAMethodCannotSample) {
    const std::string glass = "plan '" + source_path("scenes/cornell-glass.xml") + "' --method ";
    EXPECT_THAT(run(glass + "light_tracer").out, HasSubstr("not sampled: caustic\n"));
    EXPECT_THAT(run(glass + "bidirectional").out, Not(HasSubstr("unresolved")));
}

TEST_F(CommandLineTest, NamesTheWrongWordAndTheLikelyRightOne) {
    for (const auto& [arguments, error] :
         {std::pair{"rendre tiny.xml", "gibench has no command 'rendre'; did you mean 'render'? There are: run, "},
          {"", "gibench needs a command; there are: run, "},
          {"list parameters", "gibench list has no command 'parameters'. There are: methods, "},
          {"list", "gibench list needs a command; there are: methods, scenes, effects"},
          {"render tiny.xml --method path spp=16 -o a.exr",
           "gibench render: 'spp=16' is not expected; put a label in quotes: --method \"NAME spp=16\""},
          {"render tiny.xml --spp 4 --method path -o a.exr",
           "gibench render: '--spp' is not expected; parameters belong in the label"},
          {"run --seed 3 e.toml", "gibench run: '--seed' is not expected; did you mean '--seeds'?"}})
        EXPECT_THAT(run(arguments), exits(2, StartsWith(error)));
    for (const auto& [arguments, error] :
         {std::pair{"plan corner-box", "did you mean 'cornell-box'?"},
          {"plan tinny.xml", "did you mean 'tiny'?"},
          {"render tiny.xml --method photonmapper -o a.exr", "did you mean 'photon_mapper'?"},
          {"render tiny.xml --method 'vcm radus=1' -o a.exr", "did you mean 'radius'?"},
          {"tune tiny.xml --vary photon=1..2", "did you mean 'photons'? There are: "},
          {"tune corner-box", "did you mean 'cornell-box'?"},
          {"reference tiny.xml --target 1 -o a.exr", "did you mean \"1%\"?"}})
        EXPECT_THAT(run(arguments), exits(2, HasSubstr(error)));
}

TEST_F(CommandLineTest, ScenesOfTheProgramAreKnownByName) {
    EXPECT_THAT(run("plan cornell-glass").out, HasSubstr("called for: refraction\n"));
    ASSERT_EQ(run("render furnace --method 'path spp=1' --resolution 2x2 -o a.exr").code, 0);
    EXPECT_EQ(image().metadata.at("scene"), "furnace");
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
    EXPECT_EQ(completed("compare --o"), "--other-scene ");
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
        EXPECT_THAT(run(arguments), exits(2, StartsWith("r.exr:1:1: this is "))) << arguments;
        EXPECT_EQ(read_file(folder_ / "r.exr"), before) << arguments;
    }
    EXPECT_EQ(run("reference tiny.xml --target 39% -o r.exr").code, 0) << "its own scene adds to it";
    EXPECT_EQ(run("reference other.xml --target 40% --replace -o r.exr").code, 0);
    ASSERT_EQ(render("tiny.xml", "path spp=1").code, 0);
    EXPECT_EQ(run("reference tiny.xml --target 40% -o a.exr").code, 2) << "nor is an image";
}

TEST_F(CommandLineTest, ImagesOfDifferentScenesAreNotCompared) {
    ASSERT_EQ(run("reference tiny.xml --target 40% -o r.exr").code, 0);
    std::string xml = tiny_scene_xml();
    const std::size_t at = xml.find("value='5'/></emitter>");
    ASSERT_NE(at, std::string::npos);
    folder_.write("brighter.xml", xml.replace(at, 9, "value='6'"));
    ASSERT_EQ(run("render brighter.xml --method 'path spp=1' -o b.exr").code, 0);
    EXPECT_THAT(run("compare b.exr r.exr"),
                exits(2, HasSubstr("b.exr ('brighter') and r.exr ('tiny')"), HasSubstr("not of the same scene")));
    EXPECT_THAT(run("compare b.exr r.exr --other-scene --json"), prints(HasSubstr("\"rel_mse\"")));
}

TEST_F(CommandLineTest, ASceneWithoutLightIsSaid) {
    std::string xml = tiny_scene_xml();
    const std::size_t begin = xml.find("<emitter"), end = xml.find("</emitter>") + 10;
    folder_.write("dark.xml", xml.erase(begin, end - begin));
    EXPECT_THAT(render("dark.xml", "path spp=1").err, HasSubstr("warning: nothing in the scene emits light"));
    EXPECT_THAT(run("plan dark.xml").out, HasSubstr("warning: nothing in the scene emits light"));
    EXPECT_THAT(run("plan tiny.xml").out, Not(HasSubstr("warning")));
}

// A run ends with its verdict; what a machine reads stays silent.
TEST_F(CommandLineTest, ARunEndsWithItsVerdict) {
    folder_.write("e.toml",
                  "scenes = ['tiny.xml']\nseeds = 2\nbudget = { passes = 2 }\n[reference]\ntarget = '30%'\n[[method]]\n"
                  "name = 'path'\nlabel = 'my paths'\n[[method]]\nname = 'vcm'\n");
    const ProgramResult first = run("run e.toml --out new/deep/r");
    EXPECT_THAT(first, exits(0, HasSubstr("there is no folder")));
    EXPECT_THAT(first.out, AllOf(HasSubstr("my paths"), HasSubstr("\nTables: new/deep/r/table.md\nReport: "),
                                 Not(HasSubstr("| tiny |"))));
    const ProgramResult quiet = run("run e.toml --out new/quiet --quiet");
    EXPECT_EQ(quiet.out, "");
    EXPECT_THAT(quiet.err,
                AllOf(Not(HasSubstr("loaded in")), Not(HasSubstr("reference of")), Not(HasSubstr("note: "))));
    EXPECT_THAT(run("run e.toml --out new/only --only 'my p'"), exits(0));
    EXPECT_THAT(read_file(folder_ / "new/only/table.csv"), AllOf(HasSubstr("tiny,path,"), Not(HasSubstr("tiny,vcm,"))));
    EXPECT_THAT(run("run e.toml --out e.toml/r"),
                exits(2, AllOf(HasSubstr("a file is in the way"), Not(HasSubstr("loaded in")))));
    EXPECT_THAT(read_file(folder_ / "new/deep/r/table.csv"), HasSubstr("tiny,path,total"));
    const ProgramResult same = run("compare-runs new/deep/r new/deep/r --fail-if-worse");
    EXPECT_THAT(same, prints(HasSubstr("tiny, my paths\n"), HasSubstr("x 1.00 ("), HasSubstr("0 better, 0 worse")));
    EXPECT_THAT(run("compare-runs new/deep/r new/deep/r --csv").out,
                StartsWith("scene,method,number,at,before,after,factor,"));
    EXPECT_EQ(run("compare-runs new/deep/r nowhere").code, 2);
}

TEST_F(CommandLineTest, TheReferenceOfKeysAndColumnsIsMadeFromTheirDeclarations) {
    EXPECT_EQ(read_file(source_path("experiments/REFERENCE.md")),
              run("list keys --markdown").out + run("list columns --markdown").out)
        << "the head of experiments/REFERENCE.md has the command that makes it again";
}

}  // namespace
}  // namespace gib::test::command_line_test
