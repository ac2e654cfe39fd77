// Full disks and folders that cannot be written: the message has the file and the reason, no file is half-written,
// and the same command goes on once there is space.

#include "experiments/system/progress.h"
#include "tests/machine/run_content.h"
#include "tests/support/run_fixtures.h"

#include <fcntl.h>
#include <unistd.h>
#include <set>

namespace gib::test::full_disk_test {
namespace {

class FullDiskTest : public ::testing::Test, protected ExperimentFolder {
protected:
    FullDiskTest() { write_experiment("[1, 4]"); }

    ProgramResult shell(const std::string& script) const {
        write_file(path("script.sh"), "cd '" + path() + "'\ngibench='" + program_path() + "'\n" + script);
        const int status = std::system(
            ("sh '" + path("script.sh") + "' >'" + path("out.txt") + "' 2>'" + path("err.txt") + "'").c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(path("out.txt")),
                read_file(path("err.txt"))};
    }
    /// Whether this user may mount file systems that no other process sees.
    static bool may_mount() { return std::system("unshare -m mount -t tmpfs none /mnt 2>/dev/null") == 0; }
};

TEST_F(FullDiskTest, AtEveryStageIsSaidAndGoesOnWithSpace) {
    if (!may_mount()) GTEST_SKIP() << "no private file system can be mounted here";
    ASSERT_EQ(run().code, 0);
    const auto whole = content_of(results(""));
    fs::remove_all(path("results"));
    // The sizes range from a disk that holds nothing to one that lacks space for the report alone.
    std::set<std::string> files;
    for (const int kib : {4, 64, 96, 160, 320}) {
        const std::string size = std::to_string(kib) + "k";
        const ProgramResult result = shell(
            "mkdir -p results saved && rm -rf saved/*\n"
            "exec unshare -m sh -e -c \"mount -t tmpfs -o size=" +
            size +
            " none results; code=0\n"
            "'$gibench' run e.toml --threads 1 >/dev/null 2>full.txt || code=\\$?\n"
            "find results -name '*.tmp-*' >left.txt\n"
            "mount -o remount,size=100m results\n"
            "'$gibench' run e.toml --threads 1 >/dev/null 2>again.txt || exit 99\n"
            "cp -r results/e saved; exit \\$code\"\n");
        const std::string said = read_file(path("full.txt"));
        EXPECT_EQ(result.code, 1) << size << ": " << said << result.err;
        EXPECT_THAT(said, AllOf(HasSubstr("No space left on device"), HasSubstr("results/"))) << size;
        EXPECT_EQ(read_file(path("left.txt")), "") << size;
        EXPECT_THAT(read_file(path("again.txt")), Not(HasSubstr("warning"))) << size << ": half-written files";
        EXPECT_TRUE(content_of(path("saved/e")) == whole) << size;
        for (const char* file : {"references/", "checkpoint-", "final.exr", "flip", "report.html", "index.json"})
            if (said.find(file) != std::string::npos) files.insert(file);
    }
    EXPECT_GE(files.size(), 3u) << "the sizes no longer meet the stages: " << ::testing::PrintToString(files);
}

TEST_F(FullDiskTest, AFileThatMayNotGrowIsSaid) {
    // The size of files is limited for the process instead of the disk, which needs no privileges.
    write_experiment("[1]");
    EXPECT_THAT(shell("ulimit -f 4\nexec \"$gibench\" run e.toml --threads 1"), exits(1, HasSubstr("File too large")));
    EXPECT_THAT(run(), exits(0, Not(HasSubstr("warning"))));
}

TEST_F(FullDiskTest, StandardOutputToo) { EXPECT_EQ(shell("exec \"$gibench\" list methods >/dev/full").code, 1); }

TEST_F(FullDiskTest, OfStandardErrorLosesMessagesAlone) {
    write_experiment("[1]");
    ASSERT_EQ(run().code, 0);
    const auto whole = content_of(results(""));
    fs::remove_all(path("results"));
    for (const std::string command : {"run e.toml --threads 1", "reference tiny.xml --target 40% -o r.exr",
                                      "render tiny.xml --method 'path spp=1' -o x.exr"})
        EXPECT_EQ(shell("exec \"$gibench\" " + command + " 2>/dev/full").code, 0) << command;
    EXPECT_TRUE(content_of(results("")) == whole);
}

TEST(FullTerminal, DoesNotEndTheProgram) {
    const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC), saved = ::dup(STDERR_FILENO);
    ASSERT_TRUE(full >= 0 && saved >= 0);
    ::dup2(full, STDERR_FILENO);
    {
        ProgressLine line(true);
        line.update(0.5, std::nullopt, "half");
    }  // the destructor clears the line and must not throw
    ::dup2(saved, STDERR_FILENO);
    ::close(saved);
    ::close(full);
}

TEST_F(FullDiskTest, UnwritableFoldersAreRefusedBeforeAnyWork) {
    const auto refused = [&](const std::string& script, const std::string& said) {
        EXPECT_THAT(shell(script), exits(2, HasSubstr(said), Not(HasSubstr("reference of"))))
            << "or work was done: " << script;
        fs::remove_all(path("results"));
        fs::remove_all(path("r"));
    };
    const std::string go = "exec \"$gibench\" run e.toml --threads 1 --out r";
    refused("echo x >r\n" + go, "cannot make the folder 'r'");
    refused("mkdir r; echo x >r/cells\n" + go, "cannot make the folder 'r/cells'");
    refused("mkdir results; echo x >results/references\n" + go, "cannot make the folder 'results/references'");
    refused("exec \"$gibench\" run e.toml --out /proc/r", "cannot make the folder '/proc/r'");
    refused("exec \"$gibench\" tune no-such-scene --out /proc/r", "cannot make the folder '/proc/r'");
    refused("exec \"$gibench\" render tiny.xml --method path -o /proc/x.exr", "cannot write in the folder '/proc'");
    refused("exec \"$gibench\" reference tiny.xml -o /proc/x.exr", "cannot write in the folder '/proc'");
    if (may_mount())
        for (const std::string folder : {"r", "r/images", "r/cells", "results/references"})
            refused("mkdir -p r/cells r/images results/references\nexec unshare -m sh -c \"mount --bind '" + folder +
                        "' '" + folder + "' && mount -o remount,bind,ro '" + folder +
                        "' && '$gibench' run e.toml --out r\"",
                    "cannot write in the folder '" + folder + "': Read-only file system");
    if (geteuid() == 0)
        for (const std::string folder : {"r", "results/references"})
            refused(
                "mkdir -p r results/references; chmod 777 . results r results/references; chmod 555 " + folder +
                    "\nexec setpriv --reuid=65534 --regid=65534 --clear-groups \"$gibench\" run e.toml --out r",
                folder == "r" ? "cannot write in the folder 'r'" : "cannot write in the folder 'results/references'");
}

}  // namespace
}  // namespace gib::test::full_disk_test
