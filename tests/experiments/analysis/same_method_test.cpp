// Labels that differ in spp alone are one method in every comparison.
#include "experiments/analysis/same_method.h"

#include "experiments/report/report.h"

#include <gmock/gmock.h>

namespace gib::same_method_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A run whose squared relative error is 1 / seconds; a pass takes `pass_seconds`.
Cell run(const std::string& method, std::uint64_t seed, std::uint32_t passes, double pass_seconds) {
    Cell cell;
    cell.scene = "box";
    cell.method = method;
    cell.seed = seed;
    for (std::uint32_t pass = 1; pass <= passes; pass *= 2)
        cell.checkpoints.push_back(
            {{pass, pass * pass_seconds, {}, 0}, {{"total", {0, 0, 0, 0, 1 / (pass * pass_seconds)}}}});
    return cell;
}

/// Three labels of one method, of which the clock says that the shortest is the quickest, and another one.
Analysis sweep() {
    Analysis analysis;
    analysis.index.methods = {"path spp=4", "path spp=64", "path spp=16", "photon_mapper k=5 spp=64"};
    analysis.cells = {run("path spp=4", 1, 4, 0.9), run("path spp=64", 1, 64, 1), run("path spp=16", 1, 16, 0.95),
                      run("photon_mapper k=5 spp=64", 1, 64, 2)};
    for (const Cell& cell : analysis.cells) {
        TableRow row;
        row.scene = "box";
        row.method = cell.method;
        row.component = "total";
        row.seconds = cell.last().seconds;
        row.statistics = ReplicateStatistics{1, {1, {}}, {1, {}}, {1, {}}, 1, 1, {}, {}, {}};
        analysis.rows.push_back(row);
    }
    return analysis;
}

TEST(SameMethod, LabelsLoseTheirSpp) {
    EXPECT_EQ(label_without_spp("path spp=4"), "path");
    EXPECT_EQ(label_without_spp("photon_mapper spp=4 photons=1e5"), "photon_mapper photons=1e5");
    EXPECT_EQ(label_without_spp("path"), "path");
}

TEST(SameMethod, TheLongestRunStandsForAll) {
    const Analysis merged = one_label_a_method(sweep());
    std::vector<std::string> methods;
    for (const TableRow& row : merged.rows)
        methods.push_back(row.method);
    EXPECT_THAT(methods, ::testing::ElementsAre("path spp=64", "photon_mapper k=5 spp=64"));
    EXPECT_EQ(merged.cells.size(), 2u);
    EXPECT_THAT(merged.stops.at({"box", "path spp=64"}), ::testing::ElementsAre(4u, 16u));
    EXPECT_EQ(merged.stops.count({"box", "photon_mapper k=5 spp=64"}), 0u);
    EXPECT_EQ(merged.index.methods.size(), 4u) << "colours and places of the labels stay";
}

// A run that was interrupted must not hide one that has all seeds.
TEST(SameMethod, MoreCompleteSeedsComeBeforeMorePasses) {
    Analysis analysis = sweep();
    analysis.cells.push_back(run("path spp=16", 2, 16, 0.95));
    EXPECT_THAT(one_label_a_method(analysis).stops.at({"box", "path spp=16"}), ::testing::ElementsAre(4u, 64u));
}

TEST(SameMethod, NoTableComparesItWithItself) {
    const std::string text = markdown_table(sweep());
    EXPECT_THAT(text, Not(HasSubstr("path spp=4 ")));
    EXPECT_THAT(text, Not(HasSubstr("path spp=16 ")));
    EXPECT_THAT(text, AllOf(HasSubstr("| path spp=64 (stopped at spp = 4, 16 too) |"), HasSubstr("photon_mapper k=5")));
}

}  // namespace
}  // namespace gib::same_method_test
