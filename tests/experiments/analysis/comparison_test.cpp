// Comparisons of methods: errors at equal time, the Pareto frontier, and the law of the bias in a sweep.
#include "experiments/analysis/comparison.h"

#include "experiments/report/report.h"

#include <gmock/gmock.h>

#include <cmath>

namespace gib::comparison_test {
namespace {

/// A run whose rel_mse is c / seconds, with checkpoints at first, 2 first, 4 first, ... up to `seconds`.
Cell run(const std::string& method, double c, double first, double seconds) {
    Cell cell;
    cell.scene = "box";
    cell.method = method;
    std::uint32_t passes = 1;
    for (double t = first; t <= seconds; t *= 2, passes *= 2)
        cell.checkpoints.push_back({{passes, t, {}, 0}, {{"total", {0, 0, 0, 0, c / t}}}});
    return cell;
}

TableRow row(const std::string& method, std::optional<Estimate> bias2 = {}) {
    TableRow row;
    row.scene = "box";
    row.method = method;
    row.component = "total";
    row.statistics = ReplicateStatistics{5, {1, {}}, {1, {}}, {1, {}}, 1, 1, bias2, {}, {}};
    return row;
}

TEST(EqualTime, ComparesErrorsAfterTheWholeTimeOfTheFastest) {
    Analysis analysis;
    analysis.cells = {run("path", 4e-4, 0.7, 90), run("slow_start", 1e-4, 64, 128), run("photons", 1e-4, 1, 16)};
    analysis.rows = {row("path"), row("slow_start"), row("photons")};
    const auto rows = equal_time_rows(analysis);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].seconds, 16);
    ASSERT_EQ(rows[0].entries.size(), 2u) << "no image after 16 s, no entry";
    EXPECT_EQ(rows[0].entries[0].method, "photons");
    EXPECT_NEAR(rows[0].entries[0].relative_rmse, std::sqrt(1e-4 / 16), 1e-12);
    // The error lies between the checkpoints at 11.2 and 22.4 s.
    EXPECT_NEAR(rows[0].entries[1].relative_rmse, std::sqrt(4e-4 / 16), 1e-12);
    EXPECT_THAT(markdown_table(analysis), ::testing::HasSubstr("| box | total | 16.0 | photons | 0.25 | path: 2.00 |"));
}

// Its runs end after 8 and 12 s. After 10 s, their mean, the second one is not complete.
TEST(EqualTime, TheFastestHasTheErrorOfItsFinalImages) {
    Analysis analysis;
    analysis.cells = {run("fast", 4e-4, 1, 8), run("fast", 4e-4, 1.5, 12), run("slow", 1e-2, 1, 64)};
    analysis.rows = {row("fast"), row("slow")};
    const auto rows = equal_time_rows(analysis);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].seconds, 10);
    EXPECT_EQ(rows[0].entries.at(0).method, "fast");
    EXPECT_NEAR(rows[0].entries.at(0).relative_rmse, std::sqrt((4e-4 / 8 + 4e-4 / 12) / 2), 1e-12);
}

// More time would not change the image of a method that has converged.
TEST(EqualTime, DoesNotEndWithAMethodThatHasConverged) {
    Analysis analysis;
    analysis.cells = {run("path", 4e-4, 0.7, 90), run("solution", 1e-2, 1, 4), run("photons", 1e-4, 1, 16)};
    analysis.cells[1].converged = true;
    const auto methods = [&] { return cells_by_method(analysis, "box"); };
    EXPECT_EQ(equal_time(methods()), 16);
    for (Cell& cell : analysis.cells)
        cell.converged = true;
    EXPECT_NEAR(equal_time(methods()), 89.6, 1e-9) << "the longest, if each has";
}

// At 1, 2, 4 and 8 s the quick method has 4e-4 / t; the slow one starts at 4 s with 1e-4 / t.
TEST(ParetoFrontier, IsOfTheCheckpointsThatNoOtherBeats) {
    Analysis analysis;
    analysis.cells = {run("quick", 4e-4, 1, 8), run("slow", 1e-4, 4, 16)};
    const auto frontier = pareto_frontier(analysis);
    std::vector<std::pair<std::string, double>> found;
    for (const auto& point : frontier) {
        found.emplace_back(point.method, point.seconds);
        EXPECT_NEAR(point.relative_rmse, std::sqrt((point.method == "quick" ? 4e-4 : 1e-4) / point.seconds), 1e-12);
    }
    using Point = std::pair<std::string, double>;
    EXPECT_THAT(found, ::testing::ElementsAre(Point("quick", 1), Point("quick", 2), Point("slow", 4), Point("slow", 8),
                                              Point("slow", 16)));
    EXPECT_EQ(frontier[3].passes, 2u);
    EXPECT_THAT(markdown_table(analysis), ::testing::HasSubstr("| box | 8.00 | 0.35 | 2 | slow |"));
    analysis.cells.resize(1);
    EXPECT_TRUE(pareto_frontier(analysis).empty());
}

TEST(BiasLaws, FindTheExponentAmongLabelsThatDifferInOneParameter) {
    Analysis analysis;
    analysis.cells = {run("photons k=50 photons=1e4", 1, 1, 2)};
    const auto bias = [](double photons, double spread) {
        const double value = 3 * std::pow(photons, -1.5);
        return Estimate{value, Interval{value / spread, value * spread}};
    };
    for (const auto& [text, x] : {std::pair{"1e4", 1e4}, {"1e5", 1e5}, {"1e6", 1e6}})
        analysis.rows.push_back(row(std::string("photons k=50 photons=") + text, bias(x, 1.2)));
    // The first row is below what the reference resolves, the second belongs to another sweep.
    analysis.rows.push_back(row("photons k=50 photons=1e7", Estimate{1e-10, Interval{-1e-9, 1e-9}}));
    analysis.rows.push_back(row("photons k=auto photons=1e5", bias(1e7, 1.2)));
    const auto laws = bias_laws(analysis);
    ASSERT_EQ(laws.size(), 1u);
    EXPECT_EQ(laws[0].method, "photons k=50");
    EXPECT_EQ(laws[0].parameter, "photons");
    EXPECT_EQ(laws[0].resolved_count, 3u);
    EXPECT_EQ(laws[0].values.size(), 4u);
    EXPECT_NEAR(laws[0].exponent.value, 1.5, 1e-9);
    // Three points are log 10 apart, each with the deviation log 1.2 / 1.96:
    // standard error deviation / (log 10 sqrt 2).
    const double half = std::log(1.2) / (std::log(10.0) * std::sqrt(2.0));
    EXPECT_NEAR(laws[0].exponent.interval->hi, 1.5 + half, 1e-9);
    EXPECT_NEAR(laws[0].exponent.interval->lo, 1.5 - half, 1e-9);
}

TEST(BiasLaws, SayNothingOfTwoPoints) {
    Analysis analysis;
    for (const char* text : {"1e4", "1e5"}) {
        analysis.cells.push_back(run(std::string("photons photons=") + text, 1, 1, 2));
        analysis.rows.push_back(row(std::string("photons photons=") + text, Estimate{1, Interval{0.5, 2}}));
    }
    EXPECT_TRUE(bias_laws(analysis).empty());
    EXPECT_THAT(markdown_table(analysis), ::testing::Not(::testing::HasSubstr("How bias falls")));
}

}  // namespace
}  // namespace gib::comparison_test
