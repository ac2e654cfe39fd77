// `gibench run --repeat` renders the same images again, or says plainly why it does not.

#include "common/images/image_file.h"
#include "experiments/analysis/analysis.h"
#include "tests/support/run_fixtures.h"

#include <nlohmann/json.hpp>

namespace gib::test::repeat_test {
namespace {

class RepeatTest : public ::testing::Test, protected ExperimentFolder {
protected:
    ProgramResult repeat(const std::string& options = "results/e") const { return gibench("run --repeat " + options); }
    nlohmann::json manifest(const std::string& folder = "results/e") const {
        return nlohmann::json::parse(read_file(path(folder + "/manifest.json")));
    }
    void set_manifest(const nlohmann::json& manifest) { write("results/e/manifest.json", manifest.dump()); }
    /// From here on the cell of seed 1 cannot succeed: a folder stands where its image belongs.
    void block_cell(const std::string& folder, const std::string& method) const {
        const std::string image = path(folder + "/cells/" + cell_folder_name("tiny", method, 1) + "/final.exr");
        fs::remove(image);
        fs::create_directories(image + "/in-the-way");
    }
};

TEST_F(RepeatTest, RendersTheCompleteCellsAgain) {
    write_experiment("[4, 8]", "target = '40%'\n", "resolution = [12, 6]\n");
    ASSERT_EQ(run("--only spp=4").code, 0);
    EXPECT_THAT(repeat(), prints(HasSubstr("identical     tiny, path spp=4, seed 1, 4 passes\n"
                                           "identical     tiny, path spp=4, seed 2, 4 passes\n2 of 2 identical\n"),
                                 Not(HasSubstr("spp=8"))));
    for (const char* name : {"table.csv", "report.html", "images/tiny-path_spp=4.exr", "images/tiny-reference.exr"})
        EXPECT_TRUE(fs::exists(path("results/e-repeat/" + std::string(name)))) << name;
    EXPECT_EQ(read_image(path("results/e-repeat/images/tiny-path_spp=4.exr")).layers[0].second.width, 12);
    EXPECT_EQ(manifest("results/e-repeat").at("cells"), manifest().at("cells"));
    EXPECT_EQ(manifest().at("resolution"), nlohmann::json({12, 6}));
    // A repetition can be repeated, and a report can be made from its folder.
    EXPECT_EQ(repeat("results/e-repeat/ --out elsewhere").code, 0);
    EXPECT_EQ(gibench("report elsewhere").code, 0);
}

TEST_F(RepeatTest, ABudgetOfTimeBecomesItsPasses) {
    write_experiment("[100000000]", "target = '40%'\n", "budget = { seconds = 0.03 }\n");
    ASSERT_EQ(run().code, 0);
    const ProgramResult again = repeat();
    EXPECT_EQ(again.code, 0) << again.out << again.err;
    const auto cells = manifest().at("cells");
    for (const auto& cell : cells)
        EXPECT_THAT(again.out,
                    HasSubstr("seed " + cell.at("seed").dump() + ", " + cell.at("passes").dump() + " passes"));
    EXPECT_EQ(manifest("results/e-repeat").at("cells"), cells);
}

TEST_F(RepeatTest, AChangedSceneIsNamedBeforeAnythingIsDone) {
    complete("--seeds 1 --only spp=4");
    write("tiny.xml", tiny_scene_xml(9));
    EXPECT_THAT(repeat("results/e --out b"), exits(2, HasSubstr("tiny.xml:1:1: the scene was changed")));
    EXPECT_FALSE(fs::exists(path("b")));
}

TEST_F(RepeatTest, OtherImagesAreToldApart) {
    complete("--seeds 1");
    auto changed = manifest();
    changed["cells"][0]["image"] = std::string(40, '0');
    set_manifest(changed);
    EXPECT_THAT(repeat(), prints_with(1, HasSubstr("differs       tiny, path spp=4, seed 1, 4 passes: 0 of "),
                                      HasSubstr("identical     tiny, path spp=8, seed 1, 8 passes\n1 of 2 identical")));

    changed = manifest();
    changed["cells"][0]["passes"] = 3;  // the image has 4 passes
    changed["cells"][1]["method"] = "path spp=16";
    set_manifest(changed);
    EXPECT_THAT(repeat(),
                prints_with(1, ContainsRegex("differs       tiny, path spp=4, seed 1, 3 passes: [1-9][0-9]* of 1"),
                            HasSubstr("not repeated  tiny, path spp=16")));
}

TEST_F(RepeatTest, ACellThatFailedInTheRunIsLeftOut) {
    complete("--seeds 1");
    block_cell("results/e", "path spp=8");
    ASSERT_EQ(run("--seeds 1 --fresh").code, 1);
    ASSERT_EQ(manifest().at("cells").size(), 1u);
    EXPECT_THAT(repeat(), prints(HasSubstr("identical     tiny, path spp=4, seed 1, 4 passes\n1 of 1 identical\n"),
                                 Not(HasSubstr("spp=8"))));
    EXPECT_FALSE(fs::exists(path("results/e-repeat/cells/" + cell_folder_name("tiny", "path spp=8", 1))));
}

TEST_F(RepeatTest, ACellThatFailsIsNotIdenticalByAnEarlierRepetition) {
    complete("--seeds 1");
    ASSERT_EQ(repeat().code, 0);
    block_cell("results/e-repeat", "path spp=8");
    EXPECT_THAT(
        repeat(),
        prints_with(1, HasSubstr("identical     tiny, path spp=4, seed 1, 4 passes\n"),
                    ContainsRegex("not repeated  tiny, path spp=8, seed 1, 8 passes: [^\n]*final.exr: cannot write"),
                    HasSubstr("1 of 2 identical\n")));
}

TEST_F(RepeatTest, WorksFromElsewhereAndWarnsOfOtherMachines) {
    complete("--seeds 1 --only spp=4");
    auto changed = manifest();
    changed["compiler"] = "Other 1.0";
    changed["libraries"]["Embree"] = "0.1";
    set_manifest(changed);
    write("elsewhere/x", "");
    EXPECT_THAT(run_gibench("run --repeat ../results/e", path("elsewhere")),
                exits(0, HasSubstr("warning: the compiler was 'Other 1.0' and is"),
                      HasSubstr("warning: the Embree was '0.1' and is"), Not(HasSubstr("the processor was"))));
}

TEST_F(RepeatTest, ResultsOfTheCurrentFolderGoBesideIt) {
    complete("--seeds 1 --only spp=4");
    for (const auto& [folder, here] :
         {std::pair("results/e", "."), std::pair("results/e", "./"), std::pair("results/e/cells", "..")}) {
        EXPECT_THAT(run_gibench("run --repeat " + std::string(here), path(folder)), exits(0)) << here;
        EXPECT_TRUE(fs::exists(path("results/e-repeat/report.html"))) << here;
        EXPECT_FALSE(fs::exists(path("results/e/.-repeat"))) << here;
        EXPECT_FALSE(fs::exists(path("results/e/..-repeat"))) << here;
        fs::remove_all(path("results/e-repeat"));
    }
}

// If numbers were converted without a check, -1 would be 2^32 - 1 passes, which take days, and 4294967298 would be 2.
TEST_F(RepeatTest, WhatCannotBeRepeatedIsSaid) {
    const auto refused = [&](const std::string& arguments, const std::string& said) {
        EXPECT_THAT(gibench("run " + arguments), exits(2, HasSubstr(said))) << arguments;
    };
    refused("", "EXPERIMENT or --repeat");
    refused("--repeat results/e e.toml", "excludes");
    refused("--repeat results/e --threads 2", "excludes");
    refused("--repeat results/e --seeds 2", "excludes");
    refused("--repeat results/e", "manifest.json");
    write("results/e/manifest.json", "{}");
    refused("--repeat results/e", "not a manifest");
    write("results/e/manifest.json", "{\"experiment\": \"\"}");
    refused("--repeat results/e", "not a manifest that can be repeated");
    complete("--seeds 1 --only spp=4");
    for (const char* out : {"results/../results/e", "results/e/"})
        refused("--repeat results/e --out " + std::string(out), "a folder of its own");
}

}  // namespace
}  // namespace gib::test::repeat_test
