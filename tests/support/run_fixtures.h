#pragma once
// Fixtures of the tests of `gibench run`: an experiment that takes a moment, and a program that runs beside the test.

#include "tests/support/csv_reader.h"
#include "tests/support/driver_fixtures.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>

#include <map>
#include <string>

extern char** environ;

namespace gib::test {

/// A folder with tiny.xml and e.toml, whose results go to results/e.
class ExperimentFolder {
public:
    ExperimentFolder() {
        folder_.write("tiny.xml", tiny_scene_xml());
        write_experiment("[4, 8]");
    }
    void write_experiment(const std::string& spp, const std::string& reference = "target = '40%'\n",
                          const std::string& more = "") {
        folder_.write("e.toml", "title = 'Tiny'\nscenes = ['tiny.xml']\nseeds = 2\n" + more + "[reference]\n" +
                                    reference + "[[method]]\nname = 'path'\nspp = " + spp + "\n");
    }
    ProgramResult run(const std::string& options = "") const { return gibench("run e.toml --threads 1 " + options); }
    /// Puts the results here that run(options) has in a new folder, as if it had been here. They are made once in a process;
    /// the copied files keep their times and their links.
    void complete(const std::string& options = "") const {
        static std::map<std::string, ExperimentFolder> made;
        const auto [whole, is_new] = made.try_emplace(options);
        const ExperimentFolder& there = whole->second;
        if (is_new) {
            ASSERT_THAT(there.run(options), exits(0));
        }
        ASSERT_EQ(std::system(("cp -a '" + there.path("results") + "' '" + path() + "'").c_str()), 0);
        std::string manifest = read_file(results("manifest.json"));
        const std::string from = fs::path(there.path()).parent_path(), to = fs::path(path()).parent_path();
        manifest.replace(manifest.find(from), from.size(), to);
        write_file(results("manifest.json"), manifest);
    }
    ProgramResult gibench(const std::string& arguments) const { return run_gibench(arguments, folder_ / ""); }
    std::string path(const std::string& name = "") const { return folder_ / name; }
    std::string results(const std::string& name) const { return folder_ / ("results/e/" + name); }
    void write(const std::string& name, const std::string& content) { folder_.write(name, content); }
    CsvTable table(const std::string& name = "table.csv") const { return parse_csv(read_file(results(name)), name); }
    /// The time when each cell.json was last written, by the name of its cell's folder.
    std::map<std::string, fs::file_time_type> cells() const {
        std::map<std::string, fs::file_time_type> times;
        if (!fs::exists(results("cells"))) return times;
        for (const auto& cell : fs::directory_iterator(results("cells")))
            if (fs::exists(cell.path() / "cell.json"))
                times[cell.path().filename()] = fs::last_write_time(cell.path() / "cell.json");
        return times;
    }

protected:
    TemporaryFolder folder_;
};

/// `gibench ARGUMENTS` running in the background, in a process group of its own. Its standard output and error go to
/// out.txt and err.txt.
class BackgroundRun {
public:
    explicit BackgroundRun(const std::string& folder, const std::string& arguments = "run e.toml --threads 1")
        : folder_(folder) {
        std::string shell = "/bin/sh", flag = "-c";
        std::string command =
            "cd '" + folder + "' && exec '" + program_path() + "' " + arguments + " >out.txt 2>err.txt";
        char* words[] = {shell.data(), flag.data(), command.data(), nullptr};
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
        EXPECT_EQ(posix_spawn(&child_, "/bin/sh", nullptr, &attributes, words, environ), 0);
        posix_spawnattr_destroy(&attributes);
    }
    ~BackgroundRun() {
        if (child_ > 0) interrupt(SIGKILL);
    }
    BackgroundRun(const BackgroundRun&) = delete;
    BackgroundRun& operator=(const BackgroundRun&) = delete;

    pid_t pid() const { return child_; }
    bool ended() {
        if (child_ > 0 && waitpid(child_, &status_, WNOHANG) == child_) child_ = 0;
        return child_ == 0;
    }
    /// Sends `signal`, unless it is 0, to the program alone and waits until it ends. Returns the exit code, or -1 if
    /// a signal ended the program.
    int interrupt(int signal) {
        if (signal > 0 && child_ > 0) kill(child_, signal);
        return wait();
    }
    int wait() {
        if (child_ > 0) waitpid(child_, &status_, 0);
        child_ = 0;
        return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
    }
    /// The program's standard error so far.
    std::string said() const {
        const std::string file = folder_ + "/err.txt";
        return fs::exists(file) ? read_file(file) : "";
    }

private:
    std::string folder_;
    pid_t child_ = 0;
    int status_ = 0;
};

/// Waits until `condition` holds; false if it does not within two and a half minutes, which is far more than needed
/// because builds with sanitizers are slow.
template <typename Condition>
bool comes_true(const Condition& condition) {
    for (int i = 0; i < 15000; ++i) {
        if (condition()) return true;
        sleep_seconds(0.01);
    }
    return false;
}

}  // namespace gib::test
