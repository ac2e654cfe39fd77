// `gibench run --on slurm` with commands of Slurm that only say what the test wants.

#include "tests/support/run_fixtures.h"

namespace gib::test::submission_test {
namespace {

class SubmissionTest : public ::testing::Test, protected ExperimentFolder {
protected:
    SubmissionTest() {
        says("sbatch", "7");
        says("srun", "");
        says("squeue", "");
        says("scontrol", "MaxArraySize = 1001");
    }
    /// Makes a command print a text.
    void says(const std::string& command, const std::string& text) {
        write(command, "#!/bin/sh\nprintf '" + text + "\\n'\n");
        fs::permissions(path(command), fs::perms::owner_all);
    }
    ProgramResult submit(const std::string& options = "") const {
        const std::string before = std::getenv("PATH");
        ::setenv("PATH", (path() + ":" + before).c_str(), 1);
        const ProgramResult result = run("--on slurm " + options);
        ::setenv("PATH", before.c_str(), 1);
        return result;
    }
};

TEST_F(SubmissionTest, CountsCellsThatAreInJobsAlready) {
    ASSERT_EQ(run("--share 0/4").code, 0);
    EXPECT_THAT(submit(), prints(HasSubstr("cells: 1 complete, 0 in jobs already, 3 to be submitted")));
    says("squeue", "7 0\\n7 1\\n7 2\\n7 3");
    EXPECT_THAT(submit(), prints(HasSubstr("cells: 1 complete, 3 in jobs already, 0 to be submitted")))
        << "the complete cell is in a task that has not ended";
    EXPECT_THAT(submit("--only spp=8"), prints(HasSubstr("cells: 0 complete, 2 in jobs already, 0 to be submitted")))
        << "cells that are not selected do not count";
}

TEST_F(SubmissionTest, NeedsArrayJobs) {
    says("scontrol", "MaxArraySize = 0");
    EXPECT_THAT(submit(), exits(1, HasSubstr("this Slurm takes no array jobs: its MaxArraySize is 0")));
}

}  // namespace
}  // namespace gib::test::submission_test
