// Who runs the cells of an experiment, and how far they have come. tests/experiments/slurm has the tests with Slurm.

#include "tests/support/run_fixtures.h"

#include <gmock/gmock.h>

#include <cstdlib>

namespace gib::test::executor_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ExecutorTest : public ::testing::Test, protected ExperimentFolder {};

TEST_F(ExecutorTest, AnUnknownOneIsAnErrorThatNamesTheOthers) {
    const ProgramResult result = run_gibench("run e.toml --on slrum", path());
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.err, "--on knows no 'slrum'; there are: local, slurm\n");
}

TEST_F(ExecutorTest, SlurmThatIsNotThereIsAnError) {
    const std::string before = std::getenv("PATH");
    ::setenv("PATH", path().c_str(), 1);
    const ProgramResult result = run_gibench("run e.toml --on slurm", path());
    ::setenv("PATH", before.c_str(), 1);
    EXPECT_EQ(result.code, 2);
    EXPECT_THAT(result.err, HasSubstr("'sbatch', which is not on the PATH"));
    EXPECT_FALSE(fs::exists(path("results"))) << "nothing is begun";
}

TEST_F(ExecutorTest, OptionsOfSlurmNeedSlurm) {
    const ProgramResult result = run_gibench("run e.toml --sbatch=--partition=short", path());
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.err, "--sbatch is for --on slurm\n");
    EXPECT_EQ(run_gibench("run e.toml --tasks 2", path()).err, "--tasks is for --on slurm\n");
}

TEST_F(ExecutorTest, StatusCountsTheCellsOfALocalRun) {
    EXPECT_EQ(run_gibench("status results/e", path()).code, 2) << "there is none yet";
    ASSERT_EQ(run().code, 0);
    const ProgramResult all = run_gibench("status results/e", path());
    EXPECT_EQ(all.code, 0) << all.err;
    EXPECT_EQ(all.out, "references: 1 of 1\ndone: 4\nrunning: 0\nwaiting: 0\nfailed: 0\nmissing: 0\n");
    const std::string folder = (fs::directory_iterator(results("cells"))->path()).string();
    fs::remove(folder + "/cell.json");
    const ProgramResult missing = run_gibench("status results/e", path());
    EXPECT_EQ(missing.code, 1);
    EXPECT_THAT(missing.out, HasSubstr("done: 3\n"));
    EXPECT_THAT(missing.out, HasSubstr("missing: tiny, "));
    write("results/e/cells/" + fs::path(folder).filename().string() + "/failure.txt", "no memory\n");
    const ProgramResult failed = run_gibench("status results/e", path());
    EXPECT_EQ(failed.code, 1);
    EXPECT_THAT(failed.out, HasSubstr(": no memory\n"));
    EXPECT_THAT(failed.out, HasSubstr("failed: 1\n"));
    EXPECT_EQ(run().code, 0);
    EXPECT_FALSE(fs::exists(folder + "/failure.txt")) << "the cell is complete";
}

}  // namespace
}  // namespace gib::test::executor_test
