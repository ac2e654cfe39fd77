// `gibench run --share`: the shares of an experiment measure each cell once, make one reference, and have the images of a run
// of one process.

#include "experiments/results/result_folder.h"
#include "experiments/system/file_lock.h"
#include "tests/support/run_fixtures.h"

#include <nlohmann/json.hpp>

#include <set>

namespace gib::test::share_test {
namespace {

using ::testing::UnorderedElementsAre;

class ShareTest : public ::testing::Test, protected ExperimentFolder {
protected:
    /// The digests of the cells' images, by the names of their folders.
    std::map<std::string, std::string> images() const {
        std::map<std::string, std::string> digests;
        for (const auto& [name, time] : cells())
            digests[name] = nlohmann::json::parse(read_file(results("cells/" + name + "/cell.json")))
                                .at("image")
                                .get<std::string>();
        return digests;
    }
    std::set<std::string> names() const {
        std::set<std::string> found;
        for (const auto& [name, time] : cells())
            found.insert(name);
        return found;
    }
    static std::string name_of(const char* method, std::uint64_t seed) {
        return cell_folder_name("tiny", method, seed);
    }
};

TEST_F(ShareTest, TakesEveryNthCellInTheOrderOfTheRun) {
    EXPECT_THAT(run("--share 0/3"), prints(HasSubstr("share 0 of 3: 2 cells")));
    EXPECT_THAT(names(), UnorderedElementsAre(name_of("path spp=4", 1), name_of("path spp=8", 2)));
    EXPECT_FALSE(fs::exists(results("report.html"))) << "the run without --share makes it";
    EXPECT_EQ(run("--share 2/3").code, 0);
    EXPECT_THAT(names(),
                UnorderedElementsAre(name_of("path spp=4", 1), name_of("path spp=8", 2), name_of("path spp=4", 2)));
    EXPECT_THAT(run("--share 0/2 --only spp=8"), prints(HasSubstr("share 0 of 2: 1 cells")));
    EXPECT_EQ(names().count(name_of("path spp=8", 1)), 1u) << "of the selected cells";
}

TEST_F(ShareTest, ThatRunTogetherHaveTheImagesOfOneRun) {
    ASSERT_EQ(run().code, 0);
    const auto alone = images();
    fs::remove_all(path("results"));
    {
        BackgroundRun first(path(), "run e.toml --threads 1 --share 0/2");
        ASSERT_EQ(run("--share 1/2").code, 0);
        EXPECT_EQ(first.wait(), 0) << first.said();
    }
    EXPECT_EQ(images(), alone);
    EXPECT_EQ(std::distance(fs::directory_iterator(path("results/references")), {}), 2)
        << "made once: the reference, and what its methods have found";
    const auto times = cells();
    EXPECT_THAT(run(), exits(0, HasSubstr("cells complete already, not done again: 4")));
    EXPECT_EQ(cells(), times);
    EXPECT_TRUE(fs::exists(results("report.html")));
}

TEST_F(ShareTest, ThatIsKilledLeavesItsCellsToTheNext) {
    write_experiment("[1, 100000000]");  // the second cell would take hours
    BackgroundRun killed(path(), "run e.toml --threads 1 --share 1/2");
    ASSERT_TRUE(comes_true([&] { return fs::exists(results("cells/" + name_of("path spp=100000000", 1) + "/work")); }));
    // Meanwhile no other process takes the folder for itself.
    EXPECT_THAT(run(), exits(2, HasSubstr("is measuring a share of ")));
    kill(-killed.pid(), SIGKILL);
    killed.wait();
    write_experiment("[1, 2]");
    EXPECT_EQ(run("--share 1/2").code, 0);
    EXPECT_THAT(names(), UnorderedElementsAre(name_of("path spp=2", 1), name_of("path spp=2", 2)));
}

// The index that is written last knows the cells of all shares: the first share has to wait for its reference, while the second
// one makes another, measures its cell and ends.
TEST_F(ShareTest, ThatEndsLastKnowsTheCellsOfAllOthers) {
    write("other.xml", tiny_scene_xml(9));
    write("e.toml",
          "scenes = ['tiny.xml', 'other.xml']\n[reference]\ntarget = '40%'\n[[method]]\nname = 'path'\nspp = 4\n");
    ASSERT_EQ(run("--share 0/2").code, 0);
    std::string reference;
    for (const auto& file : fs::directory_iterator(path("results/references")))
        if (fs::equivalent(file, results("images/tiny-reference.exr"))) reference = file.path();
    fs::remove_all(results(""));
    auto lock = FileLock::if_free(reference + ".lock");
    BackgroundRun first(path(), "run e.toml --threads 1 --share 0/2");
    ASSERT_TRUE(comes_true([&] { return first.said().find("waiting until it has ended") != std::string::npos; }));
    ASSERT_EQ(run("--share 1/2").code, 0);
    lock.reset();
    EXPECT_EQ(first.wait(), 0) << first.said();
    EXPECT_THAT(gibench("status results/e"), prints(HasSubstr("done: 2\n")));
}

// Shares may begin beside a run, which leaves their cells to them, but then has tables without these cells.
TEST_F(ShareTest, ThatTakesACellOfARunMakesItFail) {
    write_experiment("[30000, 1]");
    BackgroundRun whole(path(), "run e.toml --threads 1 --seeds 1");
    ASSERT_TRUE(comes_true([&] { return fs::exists(results("cells/" + name_of("path spp=30000", 1) + "/work")); }));
    const std::string taken = results("cells/" + name_of("path spp=1", 1));
    fs::create_directories(taken);
    const auto lock = FileLock::if_free(taken + "/.lock");
    ASSERT_TRUE(lock);
    EXPECT_EQ(whole.wait(), 1);
    EXPECT_THAT(whole.said(), HasSubstr("1 of 2 cells are not complete; `gibench status results/e`"));
}

TEST_F(ShareTest, WhatIsNoShareIsRefused) {
    for (const char* wrong : {"2/2", "1", "a/2", "-1/2", "0/0", "1/"})
        EXPECT_THAT(run("--share " + std::string(wrong)), exits(2, HasSubstr("--share needs I/N"))) << wrong;
    EXPECT_EQ(run("--share 0/2 --on slurm").code, 2);
    EXPECT_FALSE(fs::exists(path("results")));
}

}  // namespace
}  // namespace gib::test::share_test
