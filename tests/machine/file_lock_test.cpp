// Two runs at once: in the same folder the second one is refused; for the same reference it waits.

#include "experiments/system/file_lock.h"

#include "tests/support/run_fixtures.h"

#include <gmock/gmock.h>

namespace gib::test::file_lock_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class FileLockTest : public ::testing::Test, protected ExperimentFolder {
protected:
    /// The file of the experiment's only reference, after one run.
    std::string cached_reference() const {
        for (const auto& entry : fs::directory_iterator(path("results/references")))
            if (entry.path().extension() == ".exr") return entry.path().string();
        ADD_FAILURE() << "no reference in " << path("results/references");
        return "";
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

TEST_F(FileLockTest, WhatADeadProcessLeftLocksNothing) {
    write("x.lock", "1\n");
    EXPECT_TRUE(FileLock::if_free(path("x.lock")));
    write("y.lock", "");
    EXPECT_EQ(lock_owner(path("y.lock")), "another process");
}

TEST_F(FileLockTest, ASecondRunInTheFolderIsRefusedWithThePid) {
    write_experiment("[100000000]");  // would take hours
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return fs::exists(results("index.json")); }));
    const ProgramResult second = run();
    EXPECT_EQ(second.code, 2);
    EXPECT_THAT(second.err, HasSubstr("process " + std::to_string(first.pid()) + " is working in 'results/e'"));
    EXPECT_EQ(first.interrupt(SIGTERM), 130);
    EXPECT_FALSE(fs::exists(results(".lock")));
}

TEST_F(FileLockTest, AReportBesideARunIsRefusedWithThePid) {
    write_experiment("[1, 100000000]");
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return cells().size() == 1; }));
    const ProgramResult beside = run_gibench("report results/e", path());
    EXPECT_EQ(beside.code, 2);
    EXPECT_THAT(beside.err, HasSubstr("process " + std::to_string(first.pid()) + " is working in 'results/e'"));
    EXPECT_FALSE(fs::exists(results("table.csv")));
    EXPECT_EQ(first.interrupt(SIGTERM), 130);
    const ProgramResult after = run_gibench("report results/e", path());
    EXPECT_EQ(after.code, 0) << after.err;
    EXPECT_FALSE(fs::exists(results(".lock")));
}

TEST_F(FileLockTest, AKilledRunLocksNothing) {
    write_experiment("[1, 100000000]");
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return cells().size() == 1; }));
    first.interrupt(SIGKILL);
    ASSERT_TRUE(fs::exists(results(".lock")));

    write_experiment("[1]");
    const ProgramResult second = run();
    EXPECT_EQ(second.code, 0) << second.err;
    EXPECT_FALSE(fs::exists(results(".lock")));
}

TEST_F(FileLockTest, AReferenceThatAnotherProcessMakesIsWaitedForAndUsed) {
    ASSERT_EQ(run().code, 0);
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

}  // namespace
}  // namespace gib::test::file_lock_test
