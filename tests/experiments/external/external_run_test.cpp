// Commands of other renderers as methods of an experiment. The renderer is toy_renderer.sh, which is right, too dark, or fails in one way.

#include "common/images/image_file.h"
#include "experiments/results/result_folder.h"
#include "tests/support/run_fixtures.h"
#include "tests/support/source_path.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

namespace gib::test::external_run_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ExternalRun : public ::testing::Test {
protected:
    ExternalRun() { folder_.write("tiny.xml", tiny_scene_xml()); }

    /// A [[method]] that runs the toy renderer in this mode.
    static std::string toy(const std::string& mode, const std::string& more = "") {
        return "[[method]]\nname = '" + mode + "'\ncommand = \"sh " +
               source_path("tests/experiments/external/toy_renderer.sh") + " " + mode + " " + program_path() +
               " {scene} {spp} {seed} {out}\"\n" + more;
    }
    void write(const std::string& methods, int seeds = 1, const std::string& target = "40%") {
        folder_.write("e.toml", "scenes = ['tiny.xml']\nseeds = " + std::to_string(seeds) +
                                    "\n[reference]\ntarget = '" + target + "'\n" + methods);
    }
    ProgramResult run(const std::string& options = "") {
        return run_gibench("run e.toml --threads 1 " + options, folder_ / "");
    }
    std::string results(const std::string& name) const { return folder_ / ("results/e/" + name); }
    std::string cell(const std::string& method, const std::string& file) const {
        return results("cells/" + cell_folder_name("tiny", method, 1) + "/" + file);
    }
    /// A column of the row of `total` of a method.
    std::string field(const std::string& method, const std::string& column) const {
        const CsvTable table = parse_csv(read_file(results("table.csv")), "table.csv");
        const auto at = static_cast<std::size_t>(std::find(table.columns.begin(), table.columns.end(), column) -
                                                 table.columns.begin());
        for (const auto& row : table.rows)
            if (row[1] == method && row[2] == "total") return row.at(at);
        return "no row of " + method;
    }
    TemporaryFolder folder_;
};

// The toy renderer is `path` itself, so that its image is that of the method, bit for bit.
TEST_F(ExternalRun, ARightRendererHasARowLikeAnyOther) {
    write(toy("right", "spp = [4, 8]\n") + "[[method]]\nname = 'path'\nspp = 8\n", 2);
    const ProgramResult result = run();
    ASSERT_EQ(result.code, 0) << result.err;
    for (const char* column : {"rmse", "rel_mse", "bias2", "variance", "noise_centroid", "seeds"})
        EXPECT_EQ(field("right spp=8", column), field("path spp=8", column)) << column;
    EXPECT_EQ(field("right spp=8", "external"), "yes");
    EXPECT_EQ(field("path spp=8", "external"), "");
    const LayeredImage external = read_image(cell("right spp=8", "final.exr"));
    ASSERT_EQ(external.layers.size(), 1u);
    EXPECT_EQ(external.layers[0].second.rgb, read_image(cell("path spp=8", "final.exr")).find("")->rgb);
    const std::string text = read_file(results("table.md"));
    EXPECT_THAT(text, AllOf(HasSubstr("| right spp=8 (external) |"), HasSubstr("| right spp=4 (external) |")));
    EXPECT_THAT(text, HasSubstr("| tiny | right spp=8 (external) |")) << "the strip of images";
    EXPECT_THAT(read_file(results("report.html")),
                AllOf(HasSubstr(">external<"), HasSubstr("<b class=\"name\">right spp=8</b> (external)")));
    EXPECT_THAT(run_gibench("run --repeat results/e", folder_ / "").out, HasSubstr("6 of 6 identical"));
}

// The seeds are fixed; each verdict of equal footing has a 99 % interval.
TEST_F(ExternalRun, ARendererThatIsTwoPercentTooDarkIsToldByEqualFooting) {
    write(toy("right", "spp = 256\n") + toy("dark", "spp = 256\n"), 5, "0.1%");
    const ProgramResult result = run();
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(field("dark spp=256", "footing"), "differs");
    EXPECT_NEAR(std::stod(field("dark spp=256", "energy_excess")), -0.02, 0.008);
    EXPECT_NE(field("right spp=256", "footing"), "differs");
    EXPECT_THAT(read_file(results("table.md")),
                HasSubstr("Warning: dark spp=256 differs from the reference in mean energy: `total` -"));
}

TEST_F(ExternalRun, EveryFailureIsReportedAsWhatItIs) {
    write(toy("fails") + toy("crashes") + toy("hangs", "timeout = 0.5\n") + toy("nan", "image_format = 'pfm'\n") +
          toy("small", "image_format = 'pfm'\n") + toy("nothing") + toy("right"));
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
    write(toy("slow", "spp = 1\n") + toy("right", "spp = 1\n"));
    ASSERT_EQ(run().code, 0);
    EXPECT_GE(std::stod(field("slow spp=1", "seconds")), 0.5);
    EXPECT_LT(std::stod(field("slow spp=1", "seconds")), 60);
    EXPECT_GE(std::stod(field("slow spp=1", "peak_rss_mib")), 128);
    EXPECT_LT(std::stod(field("slow spp=1", "peak_rss_mib")), 160);
    EXPECT_LT(std::stod(field("right spp=1", "peak_rss_mib")), 128);
}

TEST_F(ExternalRun, CompleteCellsAreKeptUntilTheirCommandChanges) {
    write(toy("right", "spp = 4\n"), 2);
    ASSERT_EQ(run().code, 0);
    EXPECT_THAT(run().err, HasSubstr("cells complete already, not done again: 2"));
    write(toy("right", "spp = 4\n") + "timeout = 100\n", 2);
    EXPECT_THAT(run().err, HasSubstr("cells complete already, not done again: 2")) << "a timeout changes no image";
    std::string changed = toy("right", "spp = 4\n");
    changed.replace(changed.find("sh /"), 3, "nice sh ");
    write(changed, 2);
    EXPECT_THAT(run().err,
                AllOf(HasSubstr("command or number of threads, done again: 2"), Not(HasSubstr("not done again"))));
}

TEST_F(ExternalRun, PlaceholdersAreFilledAndPathsAreThoseOfTheExperiment) {
    folder_.write("say.sh", "echo \"$@\" >said.txt\n");
    folder_.write(
        "e.toml",
        "scenes = ['tiny.xml']\nresolution = [6, 5]\n[budget]\nseconds = 2.5\n[reference]\ntarget = '40%'\n"
        "[[method]]\nname = 'say'\nquality = 'high'\nspp = 3\n"
        "command = \"sh say.sh {spp} {seconds} {seed} {threads} {width} {height} {quality} ${NO} {scene} {out}\"\n");
    EXPECT_EQ(run().code, 1);
    const std::string said = read_file(folder_ / "said.txt");
    EXPECT_THAT(said, ::testing::StartsWith("3 2.5 1 1 6 5 high /"));
    EXPECT_THAT(said, AllOf(HasSubstr(folder_ / "tiny.xml "), HasSubstr("/results/e/command/image.exr\n")));
}

TEST_F(ExternalRun, AnInterruptEndsTheCommand) {
    write(toy("hangs"));
    BackgroundRun background(folder_ / "");
    ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(cell("hangs", "stderr.txt")); }));
    EXPECT_EQ(background.interrupt(SIGINT), 130) << background.said();
}

TEST_F(ExternalRun, WhatPovrayCannotExpressStopsBeforeAnythingIsRendered) {
    write("[[method]]\nname = 'pov'\nscene_format = 'povray'\ncommand = 'povray {scene} {out}'\n");
    const ProgramResult result = run();
    EXPECT_EQ(result.code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("tiny.xml:1:"), HasSubstr("area emitters on parallelograms")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "results/references"));
}

}  // namespace
}  // namespace gib::test::external_run_test
