// Things made elsewhere: commands of other renderers as methods of an experiment, and references (`image` in
// [reference]). The renderer is toy_renderer.sh, which is right, too dark, or fails in one way.

#include "common/images/image_file.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/results/result_folder.h"
#include "tests/support/constant_image.h"
#include "tests/support/run_fixtures.h"
#include "tests/support/source_path.h"

#include <signal.h>
#include <limits>

namespace gib::test::external_run_test {
namespace {

class ExternalRun : public ::testing::Test, protected ExperimentFolder {
protected:
    /// A [[method]] that runs the toy renderer in this mode.
    static std::string toy(const std::string& mode, const std::string& more = "") {
        return "[[method]]\nname = '" + mode + "'\ncommand = \"sh " +
               source_path("tests/experiments/external/toy_renderer.sh") + " " + mode + " " + program_path() +
               " {scene} {spp} {seed} {out}\"\n" + more;
    }
    void write_methods(const std::string& methods, int seeds = 1, const std::string& target = "40%") {
        write("e.toml", "scenes = ['tiny.xml']\nseeds = " + std::to_string(seeds) + "\n[reference]\ntarget = '" +
                            target + "'\n" + methods);
    }
    std::string cell(const std::string& method, const std::string& file) const {
        return results("cells/" + cell_folder_name("tiny", method, 1) + "/" + file);
    }
    /// A column of the row of `total` of a method.
    std::string field(const std::string& method, const std::string& column) const {
        const CsvTable rows = table();
        for (std::size_t i = 0; i < rows.rows.size(); ++i)
            if (rows.rows[i][1] == method && rows.rows[i][2] == "total") return field_of(rows, column, i);
        return "no row of " + method;
    }
};

// The toy renderer is `path` itself, so that its image is that of the method, bit for bit.
TEST_F(ExternalRun, ARightRendererHasARowLikeAnyOther) {
    write_methods(toy("right", "spp = [4, 8]\n") + "[[method]]\nname = 'path'\nspp = 8\n", 2);
    ASSERT_THAT(run(), exits(0));
    for (const char* column : {"rmse", "rel_mse", "bias2", "variance", "noise_centroid", "seeds"})
        EXPECT_EQ(field("right spp=8", column), field("path spp=8", column)) << column;
    EXPECT_EQ(field("right spp=8", "external"), "yes");
    EXPECT_EQ(field("path spp=8", "external"), "");
    const LayeredImage external = read_image(cell("right spp=8", "final.exr"));
    ASSERT_EQ(external.layers.size(), 1u);
    EXPECT_EQ(external.layers[0].second.rgb, read_image(cell("path spp=8", "final.exr")).find("")->rgb);
    EXPECT_THAT(read_file(results("table.md")),
                AllOf(HasSubstr("| right spp=8 (external) |"), HasSubstr("| right spp=4 (external) |"),
                      HasSubstr("| tiny | right spp=8 (external) |")));
    EXPECT_THAT(read_file(results("report.html")),
                AllOf(HasSubstr("right spp=8 (external)</th>"), HasSubstr("right spp=8</b> (external)")));
    EXPECT_THAT(gibench("run --repeat results/e").out, HasSubstr("6 of 6 identical"));
}

// The seeds are fixed; each verdict of equal balance has a 99 % interval.
TEST_F(ExternalRun, ARendererThatIsTwoPercentTooDarkIsToldByEnergyBalance) {
    write_methods(toy("right", "spp = 256\n") + toy("dark", "spp = 256\n"), 5, "0.1%");
    ASSERT_THAT(run(), exits(0));
    EXPECT_EQ(field("dark spp=256", "footing"), "differs");
    EXPECT_NEAR(std::stod(field("dark spp=256", "energy_excess")), -0.02, 0.008);
    EXPECT_NE(field("right spp=256", "footing"), "differs");
    EXPECT_THAT(read_file(results("table.md")),
                HasSubstr("Warning: dark differs from the reference in mean energy: `total` -"));
}

// Three equal images have no scatter, and would say 'differs' of an image with few samples.
TEST_F(ExternalRun, SeedsThatMakeOneImageCountAsOne) {
    std::string fixed = toy("right", "spp = 4\n");
    fixed.replace(fixed.find("{seed}"), 6, "7");
    write_methods(fixed, 3);
    ASSERT_THAT(run(), exits(0));
    EXPECT_EQ(field("right spp=4", "seeds"), "1");
    EXPECT_EQ(field("right spp=4", "footing"), "inconclusive");
    EXPECT_THAT(read_file(results("table.md")), HasSubstr("all seeds of right spp=4 have the same image"));
}

// The command makes the same image in any time: no longer run of it would change its place.
TEST_F(ExternalRun, AnImageThatCannotTakeLongerIsNotAskedToAndABlackOneIsCalledBlack) {
    write_exr(path("black.exr"), one_layer(constant_image(0, 8, 8)));
    write_methods("[[method]]\nname = 'fixed'\ncommand = 'true {scene}; cp " + path("black.exr") +
                      " {out}'\n[[method]]\nname = 'path'\nspp = 1024\n",
                  2);
    ASSERT_THAT(run(), exits(0));
    EXPECT_THAT(read_file(results("table.md")),
                AllOf(HasSubstr("fixed differs from the reference in mean energy: `total` is black"),
                      Not(ContainsRegex("not run longer[^|]*fixed")), Not(ContainsRegex("fixed[^|]*not run longer"))));
}

TEST_F(ExternalRun, EveryFailureIsReportedAsWhatItIs) {
    write_methods(toy("fails") + toy("crashes") + toy("hangs", "timeout = 0.5\n") +
                  toy("nan", "image_format = 'pfm'\n") + toy("small", "image_format = 'pfm'\n") + toy("nothing") +
                  toy("right"));
    const ProgramResult result = run();
    EXPECT_EQ(result.code, 1);
    for (const std::string line :
         {"fails, seed 1: its command ended with exit code 3; its last message: the lamp is broken (all are in ",
          "crashes, seed 1: its command was killed by signal 11 (",
          "hangs, seed 1: its command was ended after its timeout of 0.5 s",
          "nan, seed 1: 192 of the 192 values of its image are not finite, the first in column 0 of row 0",
          "small, seed 1: its image has 4 x 4 pixels, the scene has 8 x 8",
          "nothing, seed 1: its command wrote no image"})
        EXPECT_THAT(result.err, HasSubstr("failed: tiny, " + line));
    EXPECT_THAT(result.err, HasSubstr("6 failed:"));
    EXPECT_EQ(read_file(cell("fails", "stderr.txt")), "reading the scene\nthe lamp is broken\n");
    EXPECT_EQ(field("right", "seeds"), "1");
    EXPECT_EQ(field("nan", "seeds"), "no row of nan");
}

TEST_F(ExternalRun, TheWholeCommandIsChargedAndItsMemoryIsItsOwn) {
    write_methods(toy("slow", "spp = 1\n") + toy("right", "spp = 1\n"));
    ASSERT_EQ(run().code, 0);
    const double seconds = std::stod(field("slow spp=1", "seconds"));
    EXPECT_TRUE(0.5 <= seconds && seconds < 60) << seconds;
    const double memory = std::stod(field("slow spp=1", "peak_rss_mib"));
    EXPECT_TRUE(128 <= memory && memory < 160) << memory;
    EXPECT_LT(std::stod(field("right spp=1", "peak_rss_mib")), 128);
}

TEST_F(ExternalRun, CompleteCellsAreKeptUntilTheirCommandChanges) {
    write_methods(toy("right", "spp = 4\n"), 2);
    ASSERT_EQ(run().code, 0);
    EXPECT_THAT(run().err, HasSubstr("cells complete already, not done again: 2"));
    write_methods(toy("right", "spp = 4\n") + "timeout = 100\n", 2);
    EXPECT_THAT(run().err, HasSubstr("cells complete already, not done again: 2")) << "a timeout changes no image";
    std::string changed = toy("right", "spp = 4\n");
    changed.replace(changed.find("sh /"), 3, "nice sh ");
    write_methods(changed, 2);
    EXPECT_THAT(run().err,
                AllOf(HasSubstr("command or number of threads, done again: 2"), Not(HasSubstr("not done again"))));
}

TEST_F(ExternalRun, PlaceholdersAreFilledAndPathsAreThoseOfTheExperiment) {
    write("say.sh", "echo \"$@\" >said.txt\n");
    write("e.toml",
          "scenes = ['tiny.xml']\nresolution = [6, 5]\n[budget]\nseconds = 2.5\n[reference]\ntarget = '40%'\n"
          "[[method]]\nname = 'say'\nquality = 'high'\nspp = 3\n"
          "command = \"sh say.sh {spp} {seconds} {seed} {threads} {width} {height} {quality} ${NO} {scene} {out}\"\n");
    EXPECT_EQ(run().code, 1);
    const std::string said = read_file(path("said.txt"));
    EXPECT_THAT(said, ::testing::StartsWith("3 2.5 1 1 6 5 high /"));
    EXPECT_THAT(said, AllOf(HasSubstr(path("tiny.xml ")), ContainsRegex("/results/e/command-[0-9a-f]+/image.exr\n")));
}

TEST_F(ExternalRun, AnInterruptEndsTheCommand) {
    write_methods(toy("hangs"));
    BackgroundRun background(path());
    ASSERT_TRUE(comes_true([&] { return fs::exists(cell("hangs", "stderr.txt")); }));
    EXPECT_EQ(background.interrupt(SIGINT), 130) << background.said();
}

TEST_F(ExternalRun, NothingThatACommandHasStartedOutlivesIt) {
    write_methods(toy("leaves") + toy("escapes", "timeout = 5\n"));
    EXPECT_EQ(run().code, 1);
    for (const char* file : {"left.pid", "escaped.pid"}) {
        const pid_t pid = std::stoi(read_file(path(file)));
        EXPECT_EQ(kill(pid, 0), -1) << file;
        kill(pid, SIGKILL);
    }
    EXPECT_EQ(field("leaves", "seeds"), "1");
}

// The direct light of POV-Ray on diffuse polygons is that of `path max_depth=2`: within 1 % in the mean, and within 10 % as a
// relative RMSE. The edges of the lamp make 5 % of it; a mirrored, shifted or two-sided image has more than 100 %.
TEST(PovrayRun, DirectLightAgreesWithPathTracing) {
    if (std::system("command -v povray >/dev/null") != 0) GTEST_SKIP() << "there is no povray";
    TemporaryFolder folder;
    const std::string faces = "\nf 1 2 3\nf 1 3 4\n";
    folder.write("floor.obj", "v -5 0 -5\nv -5 0 5\nv 5 0 5\nv 5 0 -5" + faces);
    folder.write("wall.obj", "v -4 -5 -5\nv -4 5 -5\nv -4 5 5\nv -4 -5 5" + faces);
    folder.write("lamp.obj", "v -1 4 -0.5\nv 1 4 -0.5\nv 1 4 0.5\nv -1 4 0.5" + faces);
    const auto mesh = [](const char* name, const std::string& surface) {
        return shape("obj", filename(name), flag("face_normals"), surface);
    };
    folder.write("floor.xml", scene_xml(camera(50, to_world(look_at("2,6,8", "-0.5,1,0")),
                                               element("film", "hdrfilm", integer("width", 48), integer("height", 32),
                                                       element("rfilter", "box"))) +
                                        mesh("floor.obj", diffuse(0.5)) +
                                        mesh("wall.obj", bsdf("twosided", one_sided("0.8,0.2,0.1"))) +
                                        mesh("lamp.obj", one_sided("0") + area_light("3,6,9")) +
                                        shape("sphere", center(1.5, 0.8, 1), radius(0.8), bsdf("diffuse"))));
    folder.write(
        "e.toml",
        "scenes = ['floor.xml']\nseeds = 2\n[reference]\nmethod = 'path max_depth=2'\ntarget = '1%'\n[[method]]\n"
        "name = 'povray'\ncommand = '" +
            source_path("scripts/povray-scene") +
            " {scene} >{out}.pov && povray +I{out}.pov +O{out} +W{width} +H{height} +WT{threads} +FE -D -GA "
            "+A0.0 +AM1 +R4 Declare=LampPoints=8'\n");
    ASSERT_THAT(run_gibench("run e.toml --threads 1", folder / ""), exits(0));
    const CsvTable table = parse_csv(read_file(folder / "results/e/table.csv"), "table.csv");
    EXPECT_NEAR(std::stod(field_of(table, "energy_excess")), 0, 0.01);
    EXPECT_LT(std::sqrt(std::stod(field_of(table, "rel_mse"))), 0.1);
}

class GivenReferenceRun : public ::testing::Test, protected ExperimentFolder {
protected:
    GivenReferenceRun() { write_experiment("4", "image = 'r.exr'\n"); }
    /// Writes an image of one value as r.exr, with a layer of the standard error if that is not empty.
    void write_image(int size, float value, std::optional<float> standard_error = {}) const {
        LayeredImage file = one_layer(constant_image(value, size, size));
        if (standard_error) file.layers.emplace_back("stderr", constant_image(*standard_error, size, size));
        write_exr(path("r.exr"), file);
    }
    std::string field(const std::string& column) const { return field_of(table(), column); }
};

TEST_F(GivenReferenceRun, WithoutAStandardErrorTheNoiseFloorIsUnknown) {
    write_image(8, 0.5f);
    ASSERT_THAT(run(), exits(0));
    EXPECT_EQ(field("rel_mse_resolved"), "");
    EXPECT_NE(field("rel_mse"), "");
    EXPECT_THAT(read_file(results("table.md")),
                AllOf(HasSubstr("Reference of tiny: the image r.exr, standard error unknown with epsilon"),
                      HasSubstr("how much of each error is its own is unknown"), Not(HasSubstr("samples a pixel"))));
    EXPECT_THAT(read_file(results("report.html")), HasSubstr("how much of each error is its own is unknown"));
    EXPECT_THAT(run().err, HasSubstr("cells complete already, not done again: 2"));
}

TEST_F(GivenReferenceRun, WithAStandardErrorItIsSubtracted) {
    write_image(8, 0.5f, 0.05f);
    ASSERT_THAT(run(), exits(0));
    const double epsilon = std::stod(field("epsilon")), expected = 0.05 * 0.05 / (0.25 + epsilon);
    EXPECT_NEAR(std::stod(field("rel_mse")) - std::stod(field("rel_mse_corrected")), expected, 1e-4 * expected);
    EXPECT_GT(std::stod(field("rel_mse_resolved")), 0);
    EXPECT_THAT(read_file(results("table.md")), HasSubstr("relative standard error 9.95"));
}

TEST_F(GivenReferenceRun, AnotherImageMeasuresTheCellsAgain) {
    write_image(8, 0.5f);
    ASSERT_EQ(run().code, 0);
    const std::string before = field("rel_mse");
    write_image(8, 0.25f);
    EXPECT_THAT(run().err, HasSubstr("done again: 2"));
    EXPECT_NE(field("rel_mse"), before);
}

TEST_F(GivenReferenceRun, AReferenceThatDoesNotFitFailsWithItsReason) {
    write_image(4, 0.5f);
    EXPECT_THAT(run().err, HasSubstr("r.exr:1:1: the reference has 4 x 4 pixels, the scene has 8 x 8"));
    write_image(8, std::numeric_limits<float>::quiet_NaN());
    EXPECT_THAT(run().err, HasSubstr("the reference has values that are not finite"));
    write_image(8, 0.f);
    EXPECT_THAT(run().err, HasSubstr("the reference is black"));
    write_image(8, 0.5f, -1.f);
    EXPECT_EQ(run().code, 1);
    const std::string scene = tiny_scene_xml(8);
    write("other.xml", std::string(scene).replace(scene.find("value='5'"), 9, "value='6'"));
    ASSERT_EQ(gibench("reference other.xml --target 40% -o r.exr --replace").code, 0);
    EXPECT_THAT(run().err, HasSubstr("the reference is that of another scene"));
}

// The size of the film, the sample count and the sampler are no part of what a scene shows.
TEST_F(GivenReferenceRun, AReferenceOfTheSameViewInAnotherFileFits) {
    write("larger.xml", tiny_scene_xml(32) + "<!-- another -->");
    ASSERT_EQ(gibench("reference larger.xml --target 40% --resolution 8x8 -o r.exr").code, 0);
    EXPECT_THAT(run(), exits(0));
}

// A reference of gibench keeps its groups, so that all intervals contain its uncertainty.
TEST_F(GivenReferenceRun, AReferenceOfGibenchCountsWithItsGroups) {
    ASSERT_EQ(gibench("reference tiny.xml --target 10% -o r.exr").code, 0);
    ASSERT_EQ(run().code, 0);
    EXPECT_EQ(read_reference(results("images/tiny-reference.exr")).total.groups.size(),
              static_cast<std::size_t>(reference_groups));
    EXPECT_THAT(read_file(results("table.md")), HasSubstr("samples a pixel, relative standard error"));
}

}  // namespace
}  // namespace gib::test::external_run_test
