// Tables: CSV that can be read back, names that Markdown does not break, and times that no seed has reached.

#include "experiments/report/tables.h"

#include "experiments/analysis/row_fields.h"
#include "experiments/report/report.h"
#include "experiments/report/words.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/csv_reader.h"
#include "tests/support/matchers.h"

#include <cmath>
#include <numeric>

namespace gib::test::tables_test {
namespace {

std::string joined(const std::vector<std::string>& names) {
    return std::accumulate(names.begin(), names.end(), std::string(),
                           [](const std::string& a, const std::string& b) { return a.empty() ? b : a + "," + b; });
}

Analysis small_analysis() {
    Analysis analysis;
    analysis.index.title = "T";
    analysis.index.scenes = {{"box", "box.xml", "h", "r", "path", 0.01, {}}};
    analysis.index.methods = {"path spp=1"};
    Cell cell = cell_of("path spp=1");
    cell.prepare_seconds = 0.25;
    cell.checkpoints.push_back({{1, 0.5, {1000, 77, {2, 0, 3}}, 12}, {{Layer::total, {1, 2, 3, 4}}}});
    cell.stages = {{"trace", 0.3}, {"other", 0.2}};
    analysis.cells.push_back(cell);
    TableRow row = row_of("path spp=1");
    row.seeds = 1;
    row.seconds = 0.5;
    row.statistics->rel_mse = {0.0025, Interval{0.0018, 0.0034}};
    row.statistics->rel_mse_corrected = 0.0016;
    row.effects_missing = {Effect::caustics, Effect::refraction};
    row.flip = 0.125;
    analysis.rows.push_back(row);
    return analysis;
}

TEST(Tables, WriteWhatWasMeasuredAndLeaveTheUnknownEmpty) {
    const Analysis analysis = small_analysis();
    EXPECT_EQ(joined(curves_table(analysis).rows.at(0)), "box,path spp=1,1,1,0.5,0.25,1000,1,2,2,12,77,4,3");
    const CsvTable table = error_table(analysis);
    const auto value = [&](const std::string& column) { return field_of(table, column); };
    EXPECT_EQ(value("rel_mse"), "0.0025");
    EXPECT_EQ(value("bias2"), "") << "one seed has no bias";
    EXPECT_EQ(value("seconds_to_1pct"), "") << "never reached is empty, not zero";
    EXPECT_EQ(value("effects_missing"), "refraction;caustics");
    EXPECT_EQ(value("flip"), "0.125");
    EXPECT_THAT(markdown_table(analysis),
                HasSubstr("| box | path | 0.500 | 4.00 (3.00 to 5.00) | needs two seeds | 0 | 0.125 | "
                          "refraction, caustics |"));
}

// Files may have such names, and a title may have several lines.
TEST(Tables, NamesDoNotBreakTheRowsOfMarkdown) {
    Analysis analysis = small_analysis();
    analysis.index.title = "T\n| a | b |";
    analysis.index.scenes[0].name = analysis.cells[0].scene = analysis.rows[0].scene = "a|b\nc";
    analysis.references.push_back({"a|b\nc", "path", 0.01, true, {}, 64, {"of a|b\nc"}, {{Layer::total, 1e-6}}});
    const std::string text = markdown_table(analysis);
    EXPECT_THAT(text, StartsWith("# T \\| a \\| b \\|\n\n"));
    EXPECT_THAT(text, HasSubstr("\n| a\\|b c | path | 0.500 |"));
    EXPECT_THAT(text, Not(HasSubstr("a|b")));
    EXPECT_THAT(text, Not(HasSubstr("b\nc")));
    EXPECT_EQ(error_table(analysis).rows.at(0).at(0), "a|b\nc") << "CSV has quotes for that";
}

/// A row of a method whose squared errors are c / t, and differ from seed to seed by a few percent.
TableRow law_row() {
    std::vector<Cell> cells;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        cells.push_back(run_of("path", 0.01 * (1 + 0.02 * static_cast<double>(seed)), 1, 64, 0, seed));
    return analysis_of(cells).rows.front();
}

// table.csv holds no time that the report does not extrapolate to; the ends of an extrapolation are those of its interval.
TEST(Times, OnlyALawThatHoldsIsExtrapolated) {
    TableRow r = law_row();
    r.is_unbiased = true;
    const auto in_csv = [&](const std::string& column) {
        Analysis analysis;
        analysis.rows = {r};
        return field_of(error_table(analysis), column);
    };
    const Field halving = next_halving_field(r);
    EXPECT_EQ(halving.state, State::extrapolated);
    EXPECT_NEAR(halving.value, 4, 1e-3);
    EXPECT_EQ(in_csv("seconds_to_1pct_state"), "extrapolated");
    EXPECT_EQ(in_csv("seconds_to_1pct"), "") << "never reached is empty";
    EXPECT_LT(std::stod(in_csv("seconds_to_1pct_lo")), 106);
    EXPECT_GT(std::stod(in_csv("seconds_to_1pct_hi")), 106);
    r.law->misfit = 0.9;
    EXPECT_EQ(next_halving_field(r).state, State::none) << "the law does not hold";
    EXPECT_EQ(in_csv("seconds_to_1pct_lo"), "");
}

TEST(Times, ASlopeThatThePointsDoNotDetermineIsNotPrinted) {
    TableRow r = law_row();
    EXPECT_EQ(slope_field(r).state, State::measured);
    r.law->misfit = 0.6;
    EXPECT_EQ(slope_field(r).state, State::inconclusive) << "the law misses a point by 60 %";
    r.law->misfit = 0;
    r.law->slope = {4, {}};
    EXPECT_EQ(slope_field(r).state, State::inconclusive) << "five seeds, and no interval";
}

// A better method may have no time where a worse one has one: its field says why.
TEST(Times, NotReachedSaysWhy) {
    TableRow r = law_row();
    r.law->misfit = 0.6;
    const Field time = time_field(r, 3);
    EXPECT_EQ(time.state, State::not_reached);
    EXPECT_THAT(line_of(time), HasSubstr("not reached (the law misses points)"));
    EXPECT_EQ(csv_state(time), "not reached") << "the state of table.csv is one of a list";
}

TEST(Csv, RoundTripKeepsCommasQuotesAndLineBreaks) {
    CsvTable table{{"a", "b,c"}, {}};
    table.add({"x\"y", "line\nbreak"});
    table.add({"", ""});
    const CsvTable back = parse_csv(table.text(), "t.csv");
    EXPECT_EQ(back.columns, table.columns);
    EXPECT_EQ(back.rows, table.rows);
    EXPECT_THROW(table.add({"only one"}), std::logic_error);
    EXPECT_THROW(parse_csv("a,b\n1\n", "t.csv"), InputError);
    EXPECT_THROW(parse_csv("a\n\"open\n", "t.csv"), InputError);
}

}  // namespace
}  // namespace gib::test::tables_test
