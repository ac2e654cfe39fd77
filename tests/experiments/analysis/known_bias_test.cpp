// Bias that is 0 by theory: which rows of the tables may say so.
#include "experiments/analysis/known_bias.h"

#include "experiments/analysis/price.h"
#include "experiments/report/row_columns.h"

#include <gtest/gtest.h>

namespace gib::known_bias_test {
namespace {

TableRow row_of(const std::string& method, const std::string& component) {
    TableRow row;
    row.scene = "box";
    row.method = method;
    row.component = component;
    row.statistics = ReplicateStatistics{};
    row.statistics->bias2 = row.statistics->rel_bias2 = Estimate{0.5, Interval{0.25, 0.75}};
    row.statistics->variance = Estimate{1, {}};
    return row;
}

std::string csv_field(const TableRow& row, const std::string& name) {
    for (const RowColumn& column : row_columns())
        if (column.name == name) return column.csv_text(row);
    return "no such column";
}

TEST(KnownBias, IsThatOfMethodsThatDeclareIt) {
    EXPECT_TRUE(is_unbiased(row_of("path spp=16", "total"), ""));
    EXPECT_TRUE(is_unbiased(row_of("bidirectional spp=16", "caustic"), ""));
    EXPECT_FALSE(is_unbiased(row_of("photon_mapper photons=1e4", "total"), ""));
    EXPECT_FALSE(is_unbiased(row_of("radiosity", "indirect"), ""));
    EXPECT_FALSE(is_unbiased(row_of("a_method_of_an_older_program", "total"), ""));
}

TEST(KnownBias, NeedsEveryPathOfTheComponent) {
    EXPECT_FALSE(is_unbiased(row_of("path spp=16", "total"), "caustic"));
    EXPECT_FALSE(is_unbiased(row_of("path spp=16", "caustic"), "caustic;volume"));
    EXPECT_TRUE(is_unbiased(row_of("path spp=16", "direct"), "caustic;volume"));
    EXPECT_FALSE(is_unbiased(row_of("path max_depth=3 spp=16", "total"), "")) << "shorter paths than the reference";
    TableRow row = row_of("path spp=16", "total");
    row.nonfinite = 1;
    EXPECT_FALSE(is_unbiased(row, "")) << "a dropped sample";
    row = row_of("path spp=16", "total");
    row.effects_missing = "caustics";
    EXPECT_FALSE(is_unbiased(row, ""));
}

// The columns of bias^2 keep the measured values; a column of its own says that theory knows better.
TEST(KnownBias, IsAStateBesideTheMeasuredValue) {
    TableRow row = row_of("path spp=16", "total");
    row.law = PriceLaw{};
    row.law->floor.value = 1;
    EXPECT_EQ(csv_field(row, "bias_state"), "measured");
    EXPECT_EQ(floor_bias2(row), 0.5);
    row.is_unbiased = true;
    EXPECT_EQ(csv_field(row, "bias_state"), "unbiased");
    EXPECT_EQ(csv_field(row, "bias2"), "0.5");
    EXPECT_EQ(floor_bias2(row), 0);
    for (const RowColumn& column : row_columns()) {
        if (column.heading != "share of bias^2") continue;
        EXPECT_EQ(column.section_text(row), "none: unbiased");
    }
    row.statistics->bias2.reset();
    EXPECT_EQ(csv_field(row, "bias_state"), "") << "one seed";
}

}  // namespace
}  // namespace gib::known_bias_test
