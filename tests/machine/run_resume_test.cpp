// `gibench run` as a whole: the files that it writes, complete cells that are kept,
// failing cells that are reported, and Ctrl-C.

#include "experiments/analysis/analysis.h"
#include "experiments/results/result_folder.h"
#include "experiments/system/file_lock.h"
#include "tests/support/run_fixtures.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gib::test::run_resume_test {
namespace {

namespace fs = std::filesystem;

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
    const ProgramResult result = run();
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, ::testing::HasSubstr("report.html"));
    for (const char* name :
         {"manifest.json", "curves.csv", "table.csv", "table.md", "spectra.csv", "stages.csv", "report.html",
          "images/tiny-reference.exr", "images/tiny-path_spp=4.exr", "images/tiny-path_spp=4-flip.png"})
        EXPECT_TRUE(fs::exists(results(name))) << name;
    EXPECT_EQ(cells().size(), 4u);
    EXPECT_EQ(table("curves.csv").rows.size(), 2u * (4 + 6)) << "passes 1 2 3 4, and 6 8 besides, for two seeds";
    const auto manifest = nlohmann::json::parse(read_file(folder_ / "results/e/manifest.json"));
    for (const char* key :
         {"commit", "compiler", "flags", "cpu", "libraries", "scenes", "experiment", "threads", "date", "command_line"})
        EXPECT_TRUE(manifest.contains(key)) << key;
    const std::string report = read_file(folder_ / "results/e/report.html");
    EXPECT_THAT(report, ::testing::HasSubstr("id=\"picture-0\""));
    EXPECT_THAT(report, ::testing::HasSubstr("Released under the MIT License"));
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "results"))
        EXPECT_NE(entry.path().filename(), "work") << "work folders are removed";
}

TEST_F(RunResumeTest, NamesThatAreNoFolderOfTheirOwnNeedAnother) {
    const std::string experiment = read_file(path("e.toml"));
    for (const std::string name : {"references", ".", ".."}) {
        write(name + ".toml", experiment);
        const ProgramResult result = run_gibench("run " + name + ".toml --threads 1", path());
        EXPECT_EQ(result.code, 2) << name << ": " << result.err;
        EXPECT_THAT(result.err, ::testing::StartsWith("an experiment cannot be named '" + name + "'"));
        EXPECT_FALSE(fs::exists(path("results")) || fs::exists(path("report.html"))) << name;
    }
    write("references.toml", experiment);
    const ProgramResult elsewhere = run_gibench("run references.toml --threads 1 --out elsewhere", path());
    EXPECT_EQ(elsewhere.code, 0) << elsewhere.err;
}

TEST_F(RunResumeTest, FlipIsMeasuredOncePerCellAndAgainForANewImage) {
    ASSERT_EQ(run().code, 0);
    const CsvTable first = table("table.csv");
    const auto at =
        static_cast<std::size_t>(std::find(first.columns.begin(), first.columns.end(), "flip") - first.columns.begin());
    ASSERT_LT(at, first.columns.size());
    for (const auto& row : first.rows)
        if (row[2] == "total") EXPECT_GT(std::stod(row[at]), 0);
        else EXPECT_EQ(row[at], "") << row[2];
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
    ASSERT_EQ(run_gibench("report results/e", folder_ / "").code, 0);
    EXPECT_TRUE(fs::exists(one + "/flip.json"));
    // A cell that is done again has another record, even if its values are the same.
    ASSERT_EQ(run("--fresh").code, 0);
    for (const auto& [file, time] : written)
        EXPECT_NE(fs::last_write_time(file), time) << file;
    ASSERT_EQ(run("--fresh").code, 0);
    EXPECT_EQ(table("table.csv").rows[0][at], first.rows[0][at]);
}

TEST_F(RunResumeTest, CompleteCellsAreNotDoneAgain) {
    ASSERT_EQ(run().code, 0);
    const auto first = cells();
    const std::string curves = read_file(folder_ / "results/e/curves.csv");
    ASSERT_EQ(run().code, 0);
    EXPECT_EQ(cells(), first);
    EXPECT_EQ(read_file(folder_ / "results/e/curves.csv"), curves);

    fs::remove_all(folder_ / ("results/e/cells/" + first.begin()->first));
    ASSERT_EQ(run().code, 0);
    const auto third = cells();
    ASSERT_EQ(third.size(), first.size());
    for (const auto& [name, time] : third) {
        if (name == first.begin()->first) EXPECT_NE(time, first.at(name));
        else EXPECT_EQ(time, first.at(name)) << name;
    }
    ASSERT_EQ(run("--fresh").code, 0);
    for (const auto& [name, time] : cells())
        EXPECT_NE(time, third.at(name)) << name;
}

TEST_F(RunResumeTest, NotesOnAReferenceStayWhenOtherScenesAreRun) {
    folder_.write("other.xml", tiny_scene_xml(9));
    folder_.write("e.toml",
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
    ASSERT_EQ(run_gibench("run --repeat results/e", path()).code, 0);
    EXPECT_THAT(read_file(path("results/e-repeat/table.md")), ::testing::HasSubstr(note));
}

TEST_F(RunResumeTest, AnEditedSceneIsDoneAgain) {
    ASSERT_EQ(run().code, 0);
    const auto first = cells();
    folder_.write("tiny.xml", tiny_scene_xml() + "<!-- edited -->");
    folder_.write("tiny.xml", tiny_scene_xml(9));
    ASSERT_EQ(run().code, 0);
    for (const auto& [name, time] : cells())
        EXPECT_NE(time, first.at(name)) << name;
}

TEST_F(RunResumeTest, ReportIsRebuiltFromStoredResultsAlone) {
    ASSERT_EQ(run().code, 0);
    const std::string table = read_file(folder_ / "results/e/table.csv");
    const std::string report = read_file(folder_ / "results/e/report.html");
    fs::remove(folder_ / "results/e/table.csv");
    fs::remove(folder_ / "results/e/report.html");
    fs::remove_all(folder_ / "results/references");
    fs::remove(folder_ / "tiny.xml");
    const ProgramResult result = run_gibench("report results/e", folder_ / "");
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(read_file(folder_ / "results/e/table.csv"), table);
    EXPECT_EQ(read_file(folder_ / "results/e/report.html"), report);
}

TEST_F(RunResumeTest, OnlyAndSeedsChooseCells) {
    ASSERT_EQ(run("--only spp=8 --seeds 1").code, 0);
    EXPECT_EQ(cells().size(), 1u);
    EXPECT_EQ(run("--only nothing").code, 2);
}

TEST_F(RunResumeTest, AFailingCellIsSaidAndTheOthersGoOn) {
    ASSERT_EQ(run("--only spp=4").code, 0);
    // A folder stands where the first process of spp=8 has to write its image, so that cell cannot succeed.
    const std::string name = [] {
        CellIdentity identity;
        identity.scene = "tiny";
        identity.method = "path spp=8";
        return cell_folder_name(identity.scene, identity.method, identity.seed);
    }();
    fs::create_directories(folder_ / ("results/e/cells/" + name + "/final.exr/in-the-way"));
    const ProgramResult result = run();
    EXPECT_EQ(result.code, 1);
    EXPECT_THAT(result.err, ::testing::HasSubstr("tiny, path spp=8, seed 1"));
    EXPECT_EQ(cells().size(), 3u) << "seed 2 and spp=4 are complete";
    EXPECT_EQ(table("table.csv").rows.at(0).at(1), "path spp=4");
}

TEST_F(RunResumeTest, InterruptedRunsKeepWhatIsCompleteAndGoOn) {
    write_experiment("[1, 100000000]");  // the second cell would take hours
    BackgroundRun first(folder_ / "");
    ASSERT_TRUE(comes_true([&] { return cells().size() == 1; }));
    sleep_seconds(0.3);
    EXPECT_EQ(first.interrupt(SIGINT), 130);
    EXPECT_THAT(read_file(folder_ / "err.txt"), ::testing::HasSubstr("interrupted"));
    EXPECT_EQ(table("curves.csv").rows.size(), 1u) << "tables hold the complete cell";

    const auto before = cells();
    const std::string curves = read_file(folder_ / "results/e/curves.csv");
    BackgroundRun second(folder_ / "");
    EXPECT_TRUE(
        comes_true([&] { return read_file(folder_ / "err.txt").find("complete already") != std::string::npos; }));
    sleep_seconds(0.3);
    EXPECT_EQ(second.interrupt(SIGTERM), 130);
    EXPECT_EQ(cells(), before);
    EXPECT_EQ(read_file(folder_ / "results/e/curves.csv"), curves);
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
        const ProgramResult next = run();
        EXPECT_EQ(next.code, 0) << next.err;
        EXPECT_THAT(next.err, ::testing::HasSubstr("not done again: 1\n"));
        expect_done_again(before);
    }
}

TEST_F(RunResumeTest, AFreshRunThatWaitsForItsReferenceHasForgottenItsCells) {
    ASSERT_EQ(run().code, 0);
    const auto before = cells();
    {
        const std::string reference = fs::directory_iterator(path("results/references"))->path().string();
        const auto lock = FileLock::if_free(reference + ".lock");
        ASSERT_TRUE(lock);
        BackgroundRun fresh(path(), "run e.toml --threads 1 --fresh");
        ASSERT_TRUE(comes_true([&] { return fresh.said().find("waiting until") != std::string::npos; }));
        EXPECT_EQ(fresh.interrupt(SIGINT), 130);
    }
    ASSERT_EQ(run().code, 0);
    expect_done_again(before);
}

}  // namespace
}  // namespace gib::test::run_resume_test
