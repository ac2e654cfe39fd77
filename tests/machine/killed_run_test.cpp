// Runs that are killed at random moments and started again end like a run that nobody disturbed.

#include "tests/machine/run_content.h"
#include "tests/support/run_fixtures.h"

#include <gmock/gmock.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <random>
#include <set>

namespace gib::test::killed_run_test {
namespace {

namespace fs = std::filesystem;

/// How often a run is killed: GIB_KILLS in the environment, else 10 times.
int kills_wanted() {
    const char* text = std::getenv("GIB_KILLS");
    return text ? std::stoi(text) : 10;
}

/// The pids of processes whose current folder is `folder`.
std::vector<std::string> processes_in(const std::string& folder) {
    std::vector<std::string> found;
    std::error_code error;
    const fs::path place = fs::canonical(folder);
    for (const auto& entry : fs::directory_iterator("/proc", error)) {
        const std::string pid = entry.path().filename().string();
        if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
        if (fs::read_symlink(entry.path() / "cwd", error) == place && !error) found.push_back(pid);
    }
    return found;
}

class KilledRunTest : public ::testing::Test, protected ExperimentFolder {
protected:
    KilledRunTest() { write_experiment("[1, 16]", "target = '20%'\n"); }

    /// Starts runs until one ends by itself; each one before is killed after a random time of up to `longest` [s].
    /// After `most_kills` kills the next run is left alone. Returns the number of kills.
    int live_once(double longest, int most_kills) {
        fs::remove_all(path("results"));
        for (int kills = 0;; ++kills) {
            BackgroundRun run(path());
            const double moment = std::uniform_real_distribution<double>(0, longest)(random_);
            for (double waited = 0; (waited < moment || kills == most_kills) && !run.ended(); waited += 0.001)
                sleep_seconds(0.001);
            if (run.ended()) {
                EXPECT_EQ(run.wait(), 0) << run.said();
                return kills;
            }
            // The signal goes to the program alone, or to the cell's process, too.
            kill(random_() % 2 == 0 ? run.pid() : -run.pid(), SIGKILL);
            run.wait();
            EXPECT_TRUE(comes_true([&] { return processes_in(path()).empty(); })) << "an orphaned process";
        }
    }
    std::mt19937 random_{20261122};  // a fixed seed: the moments are the same each time, up to the machine's speed
};

TEST_F(KilledRunTest, GoesOnToTheSameEnd) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(run().code, 0);
    const double whole = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto undisturbed = content_of(results(""));
    ASSERT_GT(undisturbed.size(), 20u);
    for (int kills = 0, lives = 0; kills < kills_wanted(); ++lives) {
        kills += live_once(0.8 * whole, kills_wanted() - kills);
        const auto end = content_of(results(""));
        ASSERT_EQ(end.size(), undisturbed.size()) << "files are missing or were left over";
        for (const auto& [name, content] : undisturbed) {
            ASSERT_EQ(end.count(name), 1u) << name;
            EXPECT_TRUE(end.at(name) == content) << name << " after " << kills << " kills in " << lives + 1 << " lives";
        }
        std::set<std::string> references;
        for (const auto& entry : fs::directory_iterator(path("results/references")))
            references.insert(entry.path().extension());
        EXPECT_THAT(references, ::testing::ElementsAre(".exr"));
        RecordProperty("lives", lives + 1);
    }
}

TEST_F(KilledRunTest, LeftOversAreRemovedByTheNextRun) {
    ASSERT_EQ(run().code, 0);
    const auto before = content_of(results(""));
    const auto all = cells();
    const std::string cell = "cells/" + std::prev(all.end(), 2)->first;  // spp=16, seed 1: it has frames
    for (const std::string& name : {std::string("table.csv.tmp-a1B2c3"), std::string("images/x.exr.tmp-linked"),
                                    cell + "/final.exr.tmp-000000", cell + "/frames/1.exr.tmp-000000",
                                    cell + "/work/checkpoint-1.exr", std::string("../references/x.exr.tmp-zzzzzz")})
        write("results/e/" + name, "half");
    write("results/e/my.backup", "the user's");
    ASSERT_EQ(run().code, 0);
    EXPECT_TRUE(fs::remove(results("my.backup")));
    EXPECT_TRUE(content_of(results("")) == before);
    EXPECT_FALSE(fs::exists(path("results/references/x.exr.tmp-zzzzzz")));

    write("out.exr.tmp-abcdef", "half");
    write("thesis.tmp-backup", "the user's");
    EXPECT_EQ(run_gibench("render tiny.xml --method 'path spp=1' -o out.exr", path()).code, 0);
    EXPECT_FALSE(fs::exists(path("out.exr.tmp-abcdef")));
    EXPECT_TRUE(fs::exists(path("thesis.tmp-backup"))) << "a folder of images is not the bench's own";
}

TEST_F(KilledRunTest, FilesThatAreBeingWrittenAreNotTaken) {
    write("a.tmp-locked", "");
    const int fd = open(path("a.tmp-locked").c_str(), O_RDONLY);
    ASSERT_EQ(flock(fd, LOCK_EX), 0);
    remove_leftovers_in(path());
    EXPECT_TRUE(fs::exists(path("a.tmp-locked")));
    close(fd);
    remove_leftovers_in(path());
    EXPECT_FALSE(fs::exists(path("a.tmp-locked")));
}

TEST_F(KilledRunTest, ACellWithoutItsRunEndsAtOnce) {
    write("request.json", "{\"parent\": 1}");
    const ProgramResult result = run_gibench("measure-cell request.json", path());
    EXPECT_EQ(result.code, 1);
    EXPECT_THAT(result.err, ::testing::HasSubstr("has ended"));
}

}  // namespace
}  // namespace gib::test::killed_run_test
