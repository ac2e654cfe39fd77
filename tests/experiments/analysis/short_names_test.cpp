// Names of methods: the key `label`, else the settings that differ; all settings where names would be equal.

#include "experiments/analysis/method_names.h"

#include "experiments/report/report.h"
#include "experiments/report/tables.h"
#include "experiments/report/terminal.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/csv_reader.h"
#include "tests/support/matchers.h"

#include <sstream>

namespace gib::test::short_names_test {
namespace {

/// An analysis with these labels, whose runs have made four passes.
Analysis of(const std::vector<std::string>& labels) {
    std::vector<Cell> cells;
    for (const std::string& label : labels)
        for (std::uint64_t seed = 1; seed <= 2; ++seed)
            cells.push_back(run_of(label, 1e-2 * (1 + 0.1 * static_cast<double>(seed)), 1, 4, 0, seed));
    return analysis_of(cells);
}

using Names = std::map<std::string, std::string>;

TEST(ShortNames, HaveTheSettingsThatDiffer) {
    EXPECT_EQ(short_names(of({"path spp=64", "photon_mapper photons=1e4 k=50", "photon_mapper photons=1e5 k=50"})),
              Names({{"path spp=64", "path"},
                     {"photon_mapper photons=1e4 k=50", "photon_mapper photons=1e4"},
                     {"photon_mapper photons=1e5 k=50", "photon_mapper photons=1e5"}}));
    EXPECT_EQ(short_names(of({"vcm", "vcm radius=0.1"})),
              Names({{"vcm", "vcm"}, {"vcm radius=0.1", "vcm radius=0.1"}}));
}

TEST(ShortNames, LeaveOutAnSppThatNoRunHasReached) {
    EXPECT_EQ(short_names(of({"path spp=4", "path spp=4096"})),
              Names({{"path spp=4", "path spp=4"}, {"path spp=4096", "path"}}));
    EXPECT_EQ(short_names(of({"path spp=4096", "path spp=1000000000"})),
              Names({{"path spp=4096", "path spp=4096"}, {"path spp=1000000000", "path spp=1000000000"}}))
        << "both would be `path`";
}

TEST(ShortNames, AreThoseThatTheExperimentGives) {
    Analysis analysis =
        of({"path", "photon_mapper photons=1e4 k=5", "photon_mapper photons=1e5 k=5", "photon_mapper gather=9"});
    analysis.index.given_names = {{"photon_mapper photons=1e4 k=5", "photon map"},
                                  {"photon_mapper photons=1e5 k=5", "photon map"},
                                  {"photon_mapper gather=9", "photon map, gathered"}};
    EXPECT_EQ(short_names(analysis), Names({{"path", "path"},
                                            {"photon_mapper photons=1e4 k=5", "photon map, photons=1e4"},
                                            {"photon_mapper photons=1e5 k=5", "photon map, photons=1e5"},
                                            {"photon_mapper gather=9", "photon map, gathered"}}));
    const std::string text = markdown_table(analysis);
    EXPECT_THAT(text, AllOf(HasSubstr("| photon map, photons=1e5 |"), HasSubstr("## Settings"),
                            HasSubstr("| box | photon map, gathered | photon_mapper gather=9 |")));
    for (const TableRow& row : with_short_names(analysis).rows)
        EXPECT_NE(analysis.row("box", with_short_names(analysis).label_of(row.method), Layer::total), nullptr);
}

TEST(ShortNames, ThatAreGivenHaveTheSettingsThatVaryBelowThemAlone) {
    Analysis analysis = of({"path", "path filter=nlm spp=4", "vcm filter=none", "vcm filter=nlm", "metropolis"});
    analysis.index.given_names = {
        {"path filter=nlm spp=4", "paths, filtered"}, {"vcm filter=none", "merged"}, {"vcm filter=nlm", "merged"}};
    EXPECT_EQ(short_names(analysis), Names({{"path", "path"},
                                            {"path filter=nlm spp=4", "paths, filtered"},
                                            {"vcm filter=none", "merged, filter=none"},
                                            {"vcm filter=nlm", "merged, filter=nlm"},
                                            {"metropolis", "metropolis"}}));
}

TEST(ShortNames, ThatAreGivenMayBeThoseOfOtherMethods) {
    Analysis analysis = of({"path filter=nlm", "path spp=4", "vcm radius=0.1"});
    analysis.index.given_names = {{"path filter=nlm", "path"}, {"vcm radius=0.1", "path spp=4"}};
    EXPECT_EQ(short_names(analysis),
              Names({{"path filter=nlm", "path"}, {"path spp=4", "path spp=4"}, {"vcm radius=0.1", "vcm radius=0.1"}}))
        << "no two names are equal";
}

// The column `method` is a key: other programs and the next run find rows by it.
TEST(ShortNames, LeaveTheKeysOfTheTablesAlone) {
    Analysis analysis = of({"path spp=64"});
    analysis.index.given_names = {{"path spp=64", "paths"}};
    analysis.rows[0].name = "paths";
    EXPECT_EQ(field_of(error_table(analysis), "method"), "path spp=64");
    EXPECT_EQ(field_of(error_table(analysis), "label"), "paths");
    EXPECT_EQ(error_table(analysis).columns.back(), "rel_mse_unmet") << "new columns stand at the end";
}

TEST(TerminalVerdict, HasTwelveLinesOfEightyColumns) {
    std::vector<std::string> labels;
    for (int i = 0; i < 30; ++i)
        labels.push_back("method_with_a_very_long_name_" + std::to_string(i) + " a_setting=" + std::to_string(i));
    std::vector<Cell> cells;
    for (const char* scene : {"one", "two", "three", "four", "five", "six", "seven"})
        for (Cell cell : of(labels).cells) {
            cell.scene = scene;
            cells.push_back(cell);
        }
    for (const Analysis& analysis : {of({"path spp=4", "vcm"}), of(labels), analysis_of(cells)}) {
        std::istringstream lines(terminal_verdict(analysis));
        int count = 0;
        for (std::string line; std::getline(lines, line); ++count)
            EXPECT_LE(line.size(), 80u) << line;
        EXPECT_LE(count, 12);
        EXPECT_GE(count, 3);
    }
    EXPECT_THAT(terminal_verdict(of({"path spp=4", "vcm"})),
                AllOf(HasSubstr("path"), HasSubstr("vcm"), HasSubstr("5 %")));
    EXPECT_THAT(terminal_verdict(of(labels)), AllOf(HasSubstr("method_with"), HasSubstr("name_0")))
        << "what tells them apart is not cut off";
}

}  // namespace
}  // namespace gib::test::short_names_test
