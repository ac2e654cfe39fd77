// Tables: their fixed columns, and CSV that can be read back.

#include "experiments/report/tables.h"
#include "experiments/report/report.h"

#include "experiments/report/row_columns.h"
#include "experiments/report/sections.h"
#include "experiments/text/numbers.h"
#include "tests/support/csv_reader.h"

#include <gmock/gmock.h>

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
    Cell cell;
    cell.scene = "box";
    cell.method = "path spp=1";
    cell.prepare_seconds = 0.25;
    cell.checkpoints.push_back({{1, 0.5, {1000, 77, {2, 0, 3}}, 12}, {{total_name, {1, 2, 3, 4, 5}}}});
    cell.stages = {{"trace", 0.3}, {"other", 0.2}};
    analysis.cells.push_back(cell);
    TableRow row;
    row.scene = "box";
    row.method = "path spp=1";
    row.component = total_name;
    row.seeds = 1;
    row.seconds = 0.5;
    row.statistics =
        ReplicateStatistics{1, {1, {}}, {1, {}}, {0.0025, Interval{0.0018, 0.0034}}, 1, 0.0016, {}, {}, {}};
    row.effects_missing = "caustics;refraction";
    row.flip = 0.125;
    analysis.rows.push_back(row);
    return analysis;
}

TEST(Tables, HaveTheFixedColumnsInOrder) {
    const Analysis analysis = small_analysis();
    using ::testing::StartsWith;
    EXPECT_THAT(
        joined(curves_table(analysis).columns),
        StartsWith(
            "scene,method,seed,pass,seconds,prepare_seconds,spp,photons,mse,rmse,rel_mse,nonfinite,peak_rss_mib"));
    EXPECT_THAT(
        joined(error_table(analysis).columns),
        StartsWith(
            "scene,method,component,seeds,seconds,rmse,rmse_lo,rmse_hi,rel_mse,rel_mse_lo,rel_mse_hi,bias2,bias2_lo,"
            "bias2_hi,variance,noise_centroid,noise_low_ratio,seconds_to_10pct,seconds_to_5pct,seconds_to_2pct,"
            "seconds_to_1pct,nonfinite,peak_rss_mib,effects_missing"));
    EXPECT_EQ(joined(stages_table(analysis).columns), "scene,method,seed,stage,seconds");
    EXPECT_THAT(joined(spectra_table(analysis).columns), StartsWith("scene,method,kind,frequency,power"));
    for (const char* further :
         {"variance_lo", "variance_hi", "rmse_corrected", "rel_mse_corrected", "seconds_to_0.5pct",
          "seconds_to_5pct_lo", "seconds_to_0.5pct_hi", "flip", "footing", "energy_excess", "rel_mse_corrected_lo",
          "rel_mse_corrected_hi", "law_slope", "law_floor_bias2", "last_halving", "next_halving_hi"})
        EXPECT_THAT(error_table(analysis).columns, ::testing::Contains(further));
}

TEST(Tables, WriteWhatWasMeasuredAndLeaveTheUnknownEmpty) {
    const Analysis analysis = small_analysis();
    EXPECT_EQ(joined(curves_table(analysis).rows.at(0)), "box,path spp=1,1,1,0.5,0.25,1,1000,1,2,3,2,12,77,5,4");
    const CsvTable table = error_table(analysis);
    const auto value = [&](const std::string& column) {
        const auto at = std::find(table.columns.begin(), table.columns.end(), column) - table.columns.begin();
        return table.rows.at(0).at(static_cast<std::size_t>(at));
    };
    EXPECT_EQ(value("rel_mse"), "0.0025");
    EXPECT_EQ(value("bias2"), "") << "one seed has no bias";
    EXPECT_EQ(value("seconds_to_1pct"), "") << "never reached is empty, not zero";
    EXPECT_EQ(value("effects_missing"), "caustics;refraction");
    EXPECT_EQ(value("flip"), "0.125");
    EXPECT_THAT(markdown_table(analysis),
                ::testing::HasSubstr(
                    "| box | path spp=1 | 0.500 | 4.00 (3.00 to 5.00) |  |  | bias or noise: two seeds would tell |  | "
                    "not reached | 0 | 0.125 | caustics, refraction |"));
}

// Files may have such names, and a title may have several lines.
TEST(Tables, NamesDoNotBreakTheRowsOfMarkdown) {
    Analysis analysis = small_analysis();
    analysis.index.title = "T\n| a | b |";
    analysis.index.scenes[0].name = analysis.cells[0].scene = analysis.rows[0].scene = "a|b\nc";
    analysis.references.push_back({"a|b\nc", "path", 0.01, true, {}, 64, {"of a|b\nc"}, {{total_name, 1e-6}}});
    const std::string text = markdown_table(analysis);
    EXPECT_THAT(text, ::testing::StartsWith("# T \\| a \\| b \\|\n\n"));
    EXPECT_THAT(text, ::testing::HasSubstr("\n| a\\|b c | path spp=1 | 0.500 |"));
    EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("a|b")));
    EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("b\nc")));
    EXPECT_EQ(error_table(analysis).rows.at(0).at(0), "a|b\nc") << "CSV has quotes for that";
}

TEST(Tables, SayWhatTheReferenceDoesNotResolve) {
    Analysis analysis = small_analysis();
    analysis.rows[0].noise_floor = 0.0025;
    EXPECT_THAT(markdown_table(analysis), ::testing::HasSubstr("| below 5.00, not resolved |"));
    EXPECT_THAT(markdown_table(analysis), ::testing::HasSubstr("| not resolved |")) << "the time to 5 %";
    analysis.rows[0].noise_floor = 0.0009;
    EXPECT_THAT(markdown_table(analysis), ::testing::HasSubstr("| 4.00 (3.00 to 5.00) |"));
}

// A member that no table shows would be lost in silence. One that is not named here does not compile.
TEST(Tables, ShowEveryMemberOfARow) {
    Analysis analysis;
    analysis.rows.resize(1);
    auto& [scene, method, component, seeds, seconds, prepare_seconds, statistics, robust, noise, bias, times, footing,
           law, last_halving, nonfinite, peak_rss_mib, effects_missing, noise_floor, flip, epsilon, components_missing,
           is_unbiased, is_external, floor_known, cpu] = analysis.rows[0];
    int number = 0;
    const auto expect_shown = [&](auto& member, auto value) {
        const auto text = [&] { return error_table(analysis).text() + spectra_table(analysis).text(); };
        const std::string before = text();
        member = std::move(value);
        EXPECT_NE(text(), before) << "member " << number;
        ++number;
    };
    expect_shown(scene, "box");
    expect_shown(method, "path");
    expect_shown(component, "total");
    expect_shown(seeds, 7);
    expect_shown(seconds, 1.5);
    expect_shown(prepare_seconds, 0.5);
    expect_shown(statistics, ReplicateStatistics{1, {1, {}}, {1, {}}, {1, {}}, 1, 1, {}, {}, {}});
    expect_shown(robust, RobustError{0.5, 0.25, 0.125});
    expect_shown(noise, NoiseSpectrum{});
    expect_shown(bias, std::vector<SpectrumPoint>(1));
    expect_shown(times[2], Estimate{3, {}});
    expect_shown(footing, Footing{});
    expect_shown(law, PriceLaw{});
    expect_shown(last_halving, Estimate{4, {}});
    expect_shown(nonfinite, 9);
    expect_shown(peak_rss_mib, 12.0);
    expect_shown(effects_missing, "caustics");
    expect_shown(noise_floor, 0.01);
    expect_shown(flip, 0.25);
    expect_shown(epsilon, 0.02);
    expect_shown(components_missing, "caustic");
    statistics->bias2 = Estimate{1, {}};
    expect_shown(is_unbiased, true);
    expect_shown(is_external, true);
    expect_shown(floor_known, false);
    expect_shown(cpu, "a processor");
}

// Every entry of row_columns() with a heading stands in table.md, so that no metric is for the CSV file alone.
TEST(Tables, ShowTheHeadingOfEveryColumn) {
    Analysis analysis = small_analysis();
    analysis.rows[0].law = PriceLaw{};
    analysis.rows[0].robust = RobustError{0.0004, 0.0009, 0.75};
    const std::string text = markdown_table(analysis);
    for (const RowColumn& column : row_columns())
        if (column.sections != 0) {
            EXPECT_THAT(text, ::testing::HasSubstr(" " + column.heading + " |"));
        }
}

TEST(Tables, KeepTheOrderOfTheSections) {
    Analysis analysis = small_analysis();
    analysis.rows[0].footing = Footing{{1, {}}, 1, {0, {}}, FootingVerdict::agrees};
    std::vector<std::string> titles;
    for (const Section& section : sections(analysis))
        titles.push_back(section.title);
    EXPECT_EQ(joined(titles), "Equal footing,Price list,Errors,Bias and noise,Where the time goes")
        << "those without rows are left out";
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

TEST(Numbers, NotANumberIsSeen) {
    EXPECT_EQ(csv_number(std::nan("")), "nan");
    EXPECT_EQ(short_number(std::nan("")), "nan");
    EXPECT_EQ(short_number(-std::nan("")), "nan");
    EXPECT_EQ(percent_text(std::nan("")), "nan");
    EXPECT_TRUE(std::isnan(at_least_zero(std::nan(""))));
    EXPECT_EQ(at_least_zero(-1), 0);
    EXPECT_EQ(short_number(0.125), "0.125");
    EXPECT_EQ(percent_text(0.125), "12.50");
}

}  // namespace
}  // namespace gib::test::tables_test
