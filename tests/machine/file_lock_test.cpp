// Two runs at once: in the same folder the second one is refused; for the same reference it waits. Executors, and the
// state of a run, are tested here, too (with Slurm in tests/experiments/slurm).

#include "experiments/system/file_lock.h"

#include "tests/support/run_fixtures.h"

#include <cstdlib>

namespace gib::test::file_lock_test {
namespace {

class FileLockTest : public ::testing::Test, protected ExperimentFolder {
protected:
    /// The file of the experiment's only reference, after one run.
    std::string cached_reference() const {
        for (const auto& entry : fs::directory_iterator(path("results/references")))
            if (entry.path().extension() == ".exr") return entry.path().string();
        ADD_FAILURE() << "no reference in " << path("results/references");
        return "";
    }
    static auto refused_for(const BackgroundRun& first) {
        return exits(2, HasSubstr("process " + std::to_string(first.pid()) + " is working in 'results/e'"));
    }
};

TEST_F(FileLockTest, IsTakenOnceAndLeavesNoFile) {
    const std::string file = path("x.lock");
    {
        const auto lock = FileLock::if_free(file);
        ASSERT_TRUE(lock);
        EXPECT_FALSE(FileLock::if_free(file));
        EXPECT_EQ(lock_owner(file), "process " + std::to_string(getpid()));
    }
    EXPECT_FALSE(fs::exists(file));
    EXPECT_TRUE(FileLock::if_free(file));
}

TEST_F(FileLockTest, ASecondRunInTheFolderIsRefusedWithThePid) {
    write_experiment("[100000000]");  // would take hours
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return fs::exists(results("index.json")); }));
    EXPECT_THAT(run(), refused_for(first));
    EXPECT_EQ(first.interrupt(SIGTERM), 130);
    EXPECT_FALSE(fs::exists(results(".lock")));
}

TEST_F(FileLockTest, AReportBesideARunIsRefusedWithThePid) {
    write_experiment("[1, 100000000]");
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return cells().size() == 1; }));
    EXPECT_THAT(gibench("report results/e"), refused_for(first));
    EXPECT_FALSE(fs::exists(results("table.csv")));
    EXPECT_EQ(first.interrupt(SIGTERM), 130);
    EXPECT_THAT(gibench("report results/e"), exits(0));
    EXPECT_FALSE(fs::exists(results(".lock")));
}

TEST_F(FileLockTest, AKilledRunLocksNothing) {
    write_experiment("[1, 100000000]");
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return cells().size() == 1; }));
    first.interrupt(SIGKILL);
    ASSERT_TRUE(fs::exists(results(".lock")));

    write_experiment("[1]");
    EXPECT_THAT(run(), exits(0));
    EXPECT_FALSE(fs::exists(results(".lock")));
}

TEST_F(FileLockTest, AReferenceThatAnotherProcessMakesIsWaitedForAndUsed) {
    complete();
    const std::string reference = cached_reference();
    const std::string content = read_file(reference);
    fs::remove_all(results(""));
    fs::remove(reference);
    auto lock = std::make_optional(lock_reference(reference, [](const std::string&) { FAIL() << "it is free"; }));
    BackgroundRun second(path());
    ASSERT_TRUE(comes_true([&] { return second.said().find("waiting") != std::string::npos; })) << second.said();
    EXPECT_THAT(second.said(), HasSubstr("tiny: process " + std::to_string(getpid()) + " is making it"));
    EXPECT_FALSE(fs::exists(reference));
    write_file(reference, content);
    lock.reset();
    EXPECT_EQ(second.wait(), 0) << second.said();
    EXPECT_THAT(second.said(), HasSubstr("(stored)"));
    EXPECT_EQ(read_file(reference), content);
}

TEST_F(FileLockTest, WaitingEndsOnCtrlC) {
    fs::create_directories(path("results/references"));
    const auto lock = FileLock::if_free(path("r.exr.lock"));
    BackgroundRun second(path(), "reference tiny.xml --target 40% -o r.exr");
    ASSERT_TRUE(comes_true([&] { return second.said().find("waiting") != std::string::npos; })) << second.said();
    EXPECT_EQ(second.interrupt(SIGINT), 130);
    EXPECT_FALSE(fs::exists(path("r.exr")));
}

class ExecutorTest : public ::testing::Test, protected ExperimentFolder {};

TEST_F(ExecutorTest, SlurmThatIsNotThereIsAnError) {
    const std::string before = std::getenv("PATH");
    ::setenv("PATH", path().c_str(), 1);
    EXPECT_THAT(gibench("run e.toml --on slurm"), exits(2, HasSubstr("'sbatch', which is not on the PATH")));
    ::setenv("PATH", before.c_str(), 1);
    EXPECT_FALSE(fs::exists(path("results"))) << "nothing is begun";
}

TEST_F(ExecutorTest, StatusCountsTheCellsOfALocalRun) {
    const auto status = [&] { return gibench("status results/e"); };
    EXPECT_EQ(status().code, 2) << "there is none yet";
    complete();
    EXPECT_THAT(status(), prints("references: 1 of 1\ndone: 4\nrunning: 0\nwaiting: 0\nfailed: 0\nmissing: 0\n"));
    const std::string cell = "cells/" + cells().begin()->first;
    fs::remove(results(cell + "/cell.json"));
    EXPECT_THAT(status(), prints_with(1, HasSubstr("done: 3\n"), HasSubstr("missing: tiny, ")));
    write("results/e/" + cell + "/failure.txt", "no memory\n");
    EXPECT_THAT(status(), prints_with(1, HasSubstr(": no memory\n"), HasSubstr("failed: 1\n")));
    EXPECT_EQ(run().code, 0);
    EXPECT_FALSE(fs::exists(results(cell + "/failure.txt"))) << "the cell is complete";
}

}  // namespace
}  // namespace gib::test::file_lock_test
