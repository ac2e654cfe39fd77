// `gibench run` as a whole: the files that it writes, complete cells that are kept, failing cells that are reported, and
// Ctrl-C. Runs that are killed at random moments and started again end like a run that nobody disturbed.

#include "experiments/analysis/analysis.h"
#include "experiments/results/result_folder.h"
#include "experiments/system/file_lock.h"
#include "tests/machine/run_content.h"
#include "tests/support/run_fixtures.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <random>
#include <set>

namespace gib::test::run_resume_test {
namespace {

class RunResumeTest : public ::testing::Test, protected ExperimentFolder {
protected:
    /// The cells are the same as before, and all were done again.
    void expect_done_again(const std::map<std::string, fs::file_time_type>& before) const {
        const auto now = cells();
        ASSERT_EQ(now.size(), before.size());
        for (const auto& [name, time] : before) {
            ASSERT_EQ(now.count(name), 1u) << name;
            EXPECT_NE(now.at(name), time) << name;
        }
    }
};

TEST_F(RunResumeTest, WritesEveryFileOfAResultFolder) {
    ASSERT_THAT(run(), prints(HasSubstr("report.html")));
    for (const char* name :
         {"manifest.json", "curves.csv", "table.csv", "table.md", "spectra.csv", "stages.csv", "report.html",
          "images/tiny-reference.exr", "images/tiny-path_spp=4.exr", "images/tiny-path_spp=4-flip.png"})
        EXPECT_TRUE(fs::exists(results(name))) << name;
    EXPECT_EQ(cells().size(), 4u);
    EXPECT_EQ(table("curves.csv").rows.size(), 2u * (4 + 6)) << "passes 1 2 3 4, and 6 8 besides, for two seeds";
    const auto manifest = nlohmann::json::parse(read_file(results("manifest.json")));
    for (const char* key :
         {"commit", "compiler", "flags", "cpu", "libraries", "scenes", "experiment", "threads", "date", "command_line"})
        EXPECT_TRUE(manifest.contains(key)) << key;
    EXPECT_THAT(read_file(results("report.html")),
                AllOf(HasSubstr("id=\"picture-0\""), HasSubstr("Released under the MIT License")));
    for (const auto& entry : fs::recursive_directory_iterator(path("results")))
        EXPECT_NE(entry.path().filename(), "work") << "work folders are removed";
}

TEST_F(RunResumeTest, NamesThatAreNoFolderOfTheirOwnNeedAnother) {
    const std::string experiment = read_file(path("e.toml"));
    for (const std::string name : {"references", ".", ".."}) {
        write(name + ".toml", experiment);
        EXPECT_THAT(gibench("run " + name + ".toml --threads 1"),
                    exits(2, StartsWith("an experiment cannot be named '" + name + "'")));
        EXPECT_FALSE(fs::exists(path("results")) || fs::exists(path("report.html"))) << name;
    }
    write("references.toml", experiment);
    EXPECT_THAT(gibench("run references.toml --threads 1 --out elsewhere"), exits(0));
}

TEST_F(RunResumeTest, FlipIsMeasuredOncePerCellAndAgainForANewImage) {
    complete();
    const CsvTable first = table();
    for (std::size_t i = 0; i < first.rows.size(); ++i)
        if (first.rows[i][2] == "total") EXPECT_GT(std::stod(field_of(first, "flip", i)), 0);
        else EXPECT_EQ(field_of(first, "flip", i), "") << first.rows[i][2];
    // Stored values are used until the cell is done again.
    std::string one;
    std::map<std::string, fs::file_time_type> written;
    for (const auto& [name, time] : cells())
        for (const char* file : {"/flip.json", "/flip.png"}) {
            one = results("cells/" + name);
            ASSERT_TRUE(fs::exists(one + file));
            written[one + file] = fs::last_write_time(one + file);
        }
    ASSERT_EQ(run().code, 0);
    for (const auto& [file, time] : written)
        EXPECT_EQ(fs::last_write_time(file), time) << file;
    fs::remove(one + "/flip.json");
    ASSERT_EQ(gibench("report results/e").code, 0);
    EXPECT_TRUE(fs::exists(one + "/flip.json"));
    // A cell that is done again has another record, even if its values are the same.
    ASSERT_EQ(run("--fresh").code, 0);
    for (const auto& [file, time] : written)
        EXPECT_NE(fs::last_write_time(file), time) << file;
    ASSERT_EQ(run("--fresh").code, 0);
    EXPECT_EQ(field_of(table(), "flip"), field_of(first, "flip"));
}

TEST_F(RunResumeTest, CompleteCellsAreNotDoneAgain) {
    complete();
    const auto first = cells();
    const std::string curves = read_file(results("curves.csv"));
    ASSERT_EQ(run().code, 0);
    EXPECT_EQ(cells(), first);
    EXPECT_EQ(read_file(results("curves.csv")), curves);

    fs::remove_all(results("cells/" + first.begin()->first));
    ASSERT_EQ(run().code, 0);
    const auto third = cells();
    ASSERT_EQ(third.size(), first.size());
    for (const auto& [name, time] : third) {
        if (name == first.begin()->first) EXPECT_NE(time, first.at(name));
        else EXPECT_EQ(time, first.at(name)) << name;
    }
    ASSERT_EQ(run("--fresh").code, 0);
    expect_done_again(third);
}

TEST_F(RunResumeTest, NotesOnAReferenceStayWhenOtherScenesAreRun) {
    write("other.xml", tiny_scene_xml(9));
    write("e.toml",
          "scenes = ['tiny.xml', 'other.xml']\n[reference]\nseconds = 0.05\ntarget = '0.001%'\n[[method]]\n"
          "name = 'path'\nspp = 1\n");
    ASSERT_EQ(run().code, 0);
    const std::string note = "its target was 0.001 %";
    const auto notes = [&] {
        const std::string text = read_file(results("table.md"));
        std::size_t count = 0;
        for (std::size_t at = 0; (at = text.find(note, at)) != std::string::npos; at += note.size())
            ++count;
        return count;
    };
    ASSERT_EQ(notes(), 2u) << read_file(results("table.md"));
    ASSERT_EQ(run("--only other").code, 0);
    EXPECT_EQ(notes(), 2u);
    ASSERT_EQ(gibench("run --repeat results/e").code, 0);
    EXPECT_THAT(read_file(path("results/e-repeat/table.md")), HasSubstr(note));
}

// The old numbers are gone then, so that it is said.
TEST_F(RunResumeTest, AnEditedSceneIsDoneAgain) {
    EXPECT_THAT(run(), exits(0, Not(HasSubstr("done again"))));
    const auto first = cells();
    write("tiny.xml", tiny_scene_xml(9));
    EXPECT_THAT(run(), exits(0, HasSubstr("done again: 4")));
    expect_done_again(first);
    EXPECT_THAT(run(), exits(0, HasSubstr("cells complete already, not done again: 4")));
}

TEST_F(RunResumeTest, ReportIsRebuiltFromStoredResultsAlone) {
    complete();
    const std::string table = read_file(results("table.csv"));
    const std::string report = read_file(results("report.html"));
    fs::remove(results("table.csv"));
    fs::remove(results("report.html"));
    fs::remove_all(path("results/references"));
    fs::remove(path("tiny.xml"));
    ASSERT_THAT(gibench("report results/e"), exits(0));
    EXPECT_EQ(read_file(results("table.csv")), table);
    EXPECT_EQ(read_file(results("report.html")), report);
}

TEST_F(RunResumeTest, OnlyAndSeedsChooseCells) {
    ASSERT_EQ(run("--only spp=8 --seeds 1").code, 0);
    EXPECT_EQ(cells().size(), 1u);
    EXPECT_EQ(run("--only nothing").code, 2);
}

TEST_F(RunResumeTest, AFailingCellIsSaidAndTheOthersGoOn) {
    ASSERT_EQ(run("--only spp=4").code, 0);
    // A folder stands where the first process of spp=8 has to write its image, so that cell cannot succeed.
    fs::create_directories(results("cells/" + cell_folder_name("tiny", "path spp=8", 1) + "/final.exr/in-the-way"));
    EXPECT_THAT(run(), exits(1, HasSubstr("tiny, path spp=8, seed 1")));
    EXPECT_EQ(cells().size(), 3u) << "seed 2 and spp=4 are complete";
    EXPECT_EQ(field_of(table(), "method"), "path spp=4");
}

TEST_F(RunResumeTest, InterruptedRunsKeepWhatIsCompleteAndGoOn) {
    write_experiment("[1, 100000000]");  // the second cell would take hours
    BackgroundRun first(path());
    ASSERT_TRUE(comes_true([&] { return cells().size() == 1; }));
    sleep_seconds(0.3);
    EXPECT_EQ(first.interrupt(SIGINT), 130);
    EXPECT_THAT(read_file(path("err.txt")), HasSubstr("interrupted"));
    EXPECT_EQ(table("curves.csv").rows.size(), 1u) << "tables hold the complete cell";

    const auto before = cells();
    const std::string curves = read_file(results("curves.csv"));
    BackgroundRun second(path());
    EXPECT_TRUE(comes_true([&] { return read_file(path("err.txt")).find("complete already") != std::string::npos; }));
    sleep_seconds(0.3);
    EXPECT_EQ(second.interrupt(SIGTERM), 130);
    EXPECT_EQ(cells(), before);
    EXPECT_EQ(read_file(results("curves.csv")), curves);
}

TEST_F(RunResumeTest, WhatAnInterruptedFreshRunDidNotReachIsDoneAgain) {
    const std::string first_record = results("cells/" + cell_folder_name("tiny", "path spp=4", 1) + "/cell.json");
    for (const int signal : {SIGINT, SIGKILL}) {
        write_experiment("[4, 8]");
        ASSERT_EQ(run().code, 0);
        const auto before = cells();
        const auto first_time = fs::last_write_time(first_record);
        write_experiment("[4, 100000000, 8]");  // the second cell would take hours
        BackgroundRun fresh(path(), "run e.toml --threads 1 --fresh");
        ASSERT_TRUE(comes_true([&] {
            std::error_code missing;
            const auto time = fs::last_write_time(first_record, missing);
            return !missing && time != first_time;
        })) << fresh.said();
        if (signal == SIGKILL) kill(-fresh.pid(), signal);  // the cell's process too
        EXPECT_EQ(fresh.interrupt(signal), signal == SIGINT ? 130 : -1);
        if (signal == SIGINT) {
            EXPECT_EQ(table("curves.csv").rows.size(), 4u) << "of the one cell that is complete";
            EXPECT_TRUE(fs::exists(results("images/tiny-path_spp=4.exr")));
            EXPECT_FALSE(fs::exists(results("images/tiny-path_spp=8.exr"))) << "of the run before";
            EXPECT_FALSE(fs::exists(results("images/tiny-path_spp=8-flip.png")));
        }
        EXPECT_EQ(cells().size(), 1u);

        write_experiment("[4, 8]");
        EXPECT_THAT(run(), exits(0, HasSubstr("not done again: 1\n")));
        expect_done_again(before);
    }
}

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
        EXPECT_THAT(references, ElementsAre(".exr"));
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
    EXPECT_EQ(gibench("render tiny.xml --method 'path spp=1' -o out.exr").code, 0);
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
    EXPECT_THAT(gibench("measure-cell request.json"), exits(1, HasSubstr("has ended")));
}

}  // namespace
}  // namespace gib::test::run_resume_test
