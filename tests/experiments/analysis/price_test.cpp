// The price of an error: when the best method changes, the cost of the last halving, and the sentences about them.

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/warnings.h"
#include "experiments/report/report.h"
#include "experiments/report/terminal.h"
#include "experiments/report/words.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/matchers.h"

#include <fmt/format.h>

#include <cmath>

namespace gib::test::price_test {
namespace {

/// run_of() with nine tenths of the error in `caustic` and one in `indirect`.
Cell run(const std::string& method, std::uint64_t seed, double c, double floor, double first, double last) {
    Cell cell = run_of(method, c, first, last, floor, seed);
    for (auto& [checkpoint, errors] : cell.checkpoints)
        for (const auto& [layer, share] : {std::pair{Layer::caustic, 0.9}, {Layer::indirect, 0.1}})
            errors[layer] = {0, 0, 0, share * errors.at(Layer::total).rel_mse_corrected};
    return cell;
}

TableRow row(const Analysis& analysis, const std::string& method, Layer layer = Layer::total) {
    const Runs cells = cells_by_method(analysis, "box").at(method);
    TableRow row = row_of(method, layer, {}, 3);
    row.statistics->rel_bias2 = Estimate{2e-4, Interval{1.21e-4, 2.89e-4}};
    row.seeds = static_cast<int>(cells.size());
    row.seconds = cells.front()->last().seconds;
    add_curve_numbers(row, cells);
    return row;
}

/// The quick method is biased, 9e-4 + 1e-3 / t, the slow one is not, 1.6e-2 / t. The curves cross where 9e-4 t =
/// 1.5e-2. Seeds differ by a few percent in their noise.
Analysis crossing() {
    Analysis analysis;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const double own = 1 + 0.02 * (static_cast<double>(seed) - 2.5);
        analysis.cells.push_back(run("quick", seed, 1e-3 * own, 9e-4, 0.5, 64));
        analysis.cells.push_back(run("exact", seed, 1.6e-2 * own, 0, 0.5, 128));
    }
    for (const char* method : {"quick", "exact"})
        for (const Layer layer : {Layer::total, Layer::caustic, Layer::indirect})
            analysis.rows.push_back(row(analysis, method, layer));
    return analysis;
}

TEST(Crossovers, AreWhereTheCurvesCross) {
    const Analysis analysis = crossing();
    const auto changes = crossovers(analysis);
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[0].method, "quick");
    EXPECT_EQ(changes[0].before, "");
    EXPECT_NEAR(changes[0].seconds, 0.5, 1e-9);
    EXPECT_EQ(changes[1].method, "exact");
    EXPECT_EQ(changes[1].before, "quick");
    // The interpolation between checkpoints is a power law: right to a few percent for the sum of floor and noise.
    EXPECT_NEAR(changes[1].seconds, 1.5e-2 / 9e-4, 0.03 * 1.5e-2 / 9e-4);
    EXPECT_NEAR(std::sqrt(changes[1].relative_rmse.value), std::sqrt(1.6e-2 / changes[1].seconds), 0.001);
    ASSERT_TRUE(changes[1].interval.has_value());
    EXPECT_LT(changes[1].interval->lo, changes[1].seconds);
    EXPECT_GT(changes[1].interval->hi, changes[1].seconds);
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| box | exact | 16."));
}

TEST(Crossovers, IgnoreMethodsThatAreLevel) {
    Analysis analysis;
    analysis.cells = {run("a", 1, 1e-2, 0, 1, 64), run("b", 1, 1.002e-2, 0, 1, 64)};
    // b is ahead by 1 % at one checkpoint.
    analysis.cells[1].checkpoints[3].errors.at(Layer::total).rel_mse_corrected *= 0.98;
    EXPECT_EQ(crossovers(analysis).size(), 1u);
}

TEST(LastHalving, IsMeasuredWithPreparation) {
    Analysis analysis = crossing();
    // The error is noise alone, so it halves when time grows fourfold.
    EXPECT_NEAR(row(analysis, "exact").last_halving->value, 4, 1e-9);
    // The squared error is 9e-4 + 1e-3 / t. Twice the final error, whose
    // square is 9.156e-4, occurs only before 0.37 s.
    EXPECT_FALSE(row(analysis, "quick").last_halving.has_value());
}

TEST(Verdicts, NeverNameAMethodThatLeavesOutAnEffect) {
    Analysis analysis = crossing();
    for (TableRow& row : analysis.rows)
        if (row.method == "quick") row.effects_missing = {Effect::caustics};
    EXPECT_EQ(verdict(analysis, "box")[0].method, "exact");
    EXPECT_TRUE(verdict(analysis, "box")[0].is_best);
    for (TableRow& row : analysis.rows)
        row.effects_missing = {Effect::caustics};
    for (const VerdictRow& row : verdict(analysis, "box"))
        EXPECT_FALSE(row.is_best);
}

TEST(Verdicts, NeverNameAMethodThatLeavesOutLightOfAComponent) {
    Analysis analysis = crossing();
    for (TableRow& row : analysis.rows)
        if (row.method == "quick") row.components_missing = {Component::caustic, Component::indirect};
    const auto rows = verdict(analysis, "box");
    EXPECT_EQ(rows[0].method, "exact");
    EXPECT_EQ(rows[1].method, "quick");
    EXPECT_THAT(rows[1].remark, HasSubstr("leaves out light of caustic, indirect"));
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| light of caustic, indirect |"));
}

TEST(Verdicts, NameNoMethodWhereAPartOfTheLightHasNoVerdict) {
    Analysis analysis = crossing();
    analysis.references.emplace_back();
    analysis.references[0].scene = "box";
    analysis.references[0].unjudged = {Component::caustic};
    const auto rows = verdict(analysis, "box");
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].method, "");
    EXPECT_EQ(rows[0].remark, "the reference is incomplete or contradicted in caustic");
    EXPECT_TRUE(crossovers(analysis).empty());
    EXPECT_TRUE(pareto_frontier(analysis).empty());
    for (const EqualTimeRow& row : equal_time_rows(analysis))
        EXPECT_NE(row.layer, Layer::total);
    EXPECT_FALSE(equal_time_rows(analysis).empty()) << "components that are judged keep their rows";
}

// The runs end after 64 and 96 s. At their mean, 80 s, the longer one has not got its final image.
TEST(Verdicts, GiveTheClosestTheErrorOfItsFinalImages) {
    Analysis analysis;
    analysis.cells = {run("a", 1, 10, 0, 1.5, 96), run("a", 2, 10, 0, 1, 64), run("b", 1, 40, 0, 1, 64)};
    for (const char* method : {"a", "b"})
        analysis.rows.push_back(row(analysis, method));
    analysis.rows[0].seconds = 80;
    const double final_error = std::sqrt((10. / 96 + 10. / 64) / 2);
    const auto rows = verdict(analysis, "box");
    EXPECT_EQ(rows[0].method, "a");
    EXPECT_NEAR(std::sqrt(rows[0].error.value), final_error, 1e-9);
}

TEST(BalanceWarnings, CompareMethodsWhereTheReferenceIsInconclusive) {
    Analysis analysis;
    analysis.index.seeds = 4;
    const Estimate unknown{0.1, Interval{-0.2, 0.4}};
    for (const auto& [method, energy, deviation] :
         {std::tuple{"a", 1.0, 0.0005}, {"b", 1.03, 0.0005}, {"c", 1.002, 0.0005}, {"d", 1.4, 0.5}}) {
        analysis.rows.push_back(row_of(method, Layer::indirect));
        analysis.rows.back().balance =
            EnergyBalance{{energy, {deviation * deviation, 3}}, 1, unknown, BalanceVerdict::inconclusive};
    }
    const auto warnings = balance_warnings(analysis);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].kind, Warning::Kind::energy_differs);
    EXPECT_THAT(warnings[0].sentence, AllOf(HasSubstr("methods differ in mean energy of `indirect`"),
                                            HasSubstr("b has +3.00 %"), HasSubstr("over a")));
    analysis.rows[1].balance->excess.interval.reset();
    EXPECT_EQ(balance_warnings(analysis).size(), 0u) << "all images of b are equal: they have missed the same paths";
    analysis.rows[1].balance->excess.interval = unknown.interval;
    analysis.rows[1].effects_missing = {Effect::refraction};
    EXPECT_EQ(balance_warnings(analysis).size(), 0u) << "b leaves out light, which is no disagreement";
    analysis.rows[1].effects_missing = {};
    analysis.rows[1].components_missing = {Component::caustic, Component::indirect};
    EXPECT_EQ(balance_warnings(analysis).size(), 0u);
    analysis.rows[1].components_missing = {Component::caustic};
    EXPECT_EQ(balance_warnings(analysis).size(), 1u) << "it has all light of this component";
}

}  // namespace
}  // namespace gib::test::price_test
