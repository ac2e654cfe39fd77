// Tables: their fixed columns, CSV that can be read back, and the words about bias and noise, about what is left out, and
// about times that were not reached.

#include "experiments/report/tables.h"

#include "experiments/analysis/row_fields.h"
#include "experiments/report/report.h"
#include "experiments/report/sections.h"
#include "experiments/report/words.h"
#include "experiments/text/numbers.h"
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
    cell.checkpoints.push_back({{1, 0.5, {1000, 77, {2, 0, 3}}, 12}, {{Layer::total, {1, 2, 3, 4, 5}}}});
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

TEST(Tables, HaveTheFixedColumnsInOrder) {
    const Analysis analysis = small_analysis();
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
        EXPECT_THAT(error_table(analysis).columns, Contains(further));
}

TEST(Tables, WriteWhatWasMeasuredAndLeaveTheUnknownEmpty) {
    const Analysis analysis = small_analysis();
    EXPECT_EQ(joined(curves_table(analysis).rows.at(0)), "box,path spp=1,1,1,0.5,0.25,1,1000,1,2,3,2,12,77,5,4");
    const CsvTable table = error_table(analysis);
    const auto value = [&](const std::string& column) { return field_of(table, column); };
    EXPECT_EQ(value("rel_mse"), "0.0025");
    EXPECT_EQ(value("bias2"), "") << "one seed has no bias";
    EXPECT_EQ(value("seconds_to_1pct"), "") << "never reached is empty, not zero";
    EXPECT_EQ(value("effects_missing"), "refraction;caustics");
    EXPECT_EQ(value("flip"), "0.125");
    EXPECT_THAT(markdown_table(analysis),
                HasSubstr("| box | path | 0.500 | 4.00 (3.00 to 5.00) |  |  | bias or noise: two seeds would tell |  | "
                          "not reached | 0 | 0.125 | refraction, caustics |"));
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

TEST(Tables, SayWhatTheReferenceDoesNotResolve) {
    Analysis analysis = small_analysis();
    analysis.rows[0].noise_floor = 0.0025;
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| below 5.00, not resolved |"));
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| not resolved |")) << "the time to 5 %";
    analysis.rows[0].noise_floor = 0.0009;
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| 4.00 (3.00 to 5.00) |"));
}

// A member that no table shows would be lost in silence. One that is not named here does not compile.
TEST(Tables, ShowEveryMemberOfARow) {
    Analysis analysis;
    analysis.rows.resize(1);
    auto& [scene, method, name, layer, seeds, seconds, prepare_seconds, least_passes, most_passes, statistics, robust,
           noise, bias, times, reached, footing, law, last_halving, nonfinite, peak_rss_mib, effects_missing,
           noise_floor, flip, epsilon, components_missing, is_unbiased, contradicted_in, unmet, has_times, is_external,
           floor_known, cpus] = analysis.rows[0];
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
    expect_shown(name, "paths");
    expect_shown(layer, Layer::caustic);
    expect_shown(seeds, 7);
    expect_shown(seconds, 1.5);
    expect_shown(prepare_seconds, 0.5);
    expect_shown(most_passes, 9);
    expect_shown(least_passes, 8);
    expect_shown(statistics, ReplicateStatistics{1, {1, {}}, {1, {}}, {1, {}}, 1, 1, {}, {}, {}});
    expect_shown(robust, RobustError{0.5, 0.25, 0.125});
    expect_shown(noise, NoiseSpectrum{});
    expect_shown(bias, std::vector<SpectrumPoint>(1));
    expect_shown(times[2], Estimate{3, {}});
    expect_shown(reached[0], 1);
    expect_shown(footing, Footing{});
    expect_shown(law, PriceLaw{});
    expect_shown(last_halving, Estimate{4, {}});
    expect_shown(nonfinite, 9);
    expect_shown(peak_rss_mib, 12.0);
    expect_shown(effects_missing, Effects({Effect::caustics}));
    expect_shown(noise_floor, 0.01);
    expect_shown(flip, 0.25);
    expect_shown(epsilon, 0.02);
    expect_shown(components_missing, Components({Component::caustic}));
    statistics->bias2 = Estimate{1, {}};
    expect_shown(contradicted_in, std::vector<Layer>({Layer::caustic}));
    expect_shown(is_unbiased, true);
    expect_shown(unmet, 0.5);
    expect_shown(has_times, false);
    expect_shown(is_external, true);
    expect_shown(floor_known, false);
    expect_shown(cpus, std::set<std::string>({"a processor"}));
}

// Every entry of row_columns() with a heading stands in table.md, so that no metric is for the CSV file alone.
TEST(Tables, ShowTheHeadingOfEveryColumn) {
    Analysis analysis = small_analysis();
    analysis.rows[0].law = PriceLaw{};
    analysis.rows[0].robust = RobustError{0.0004, 0.0009, 0.75};
    const std::string text = markdown_table(analysis);
    for (const RowColumn& column : row_columns())
        if (column.sections != 0) {
            EXPECT_THAT(text, HasSubstr(" " + column.heading + " |"));
        }
}

TEST(Tables, KeepTheOrderOfTheSections) {
    Analysis analysis = small_analysis();
    analysis.rows[0].footing = Footing{{1, {}}, 1, {0, {}}, FootingVerdict::agrees};
    std::vector<std::string> titles;
    for (const Section& section : sections(analysis))
        titles.push_back(section.title);
    EXPECT_EQ(joined(titles),
              "Which method is cheapest, and why,Equal footing,Price list,Errors,Bias and noise,Where the time goes")
        << "those without rows are left out";
}

/// A row of images with these parts of the mean squared error, and a relative RMSE of 10 % with the same parts.
TableRow error_row(const std::string& method, const Estimate& bias2, double variance) {
    TableRow row = row_of(method, Layer::total, bias2, 5);
    row.statistics->rel_mse = {0.01, {}};
    row.statistics->rmse_corrected = 0.1;
    row.statistics->rel_mse_corrected = 0.01;
    row.statistics->variance = Estimate{variance, {}};
    const double scale = 0.01 / (bias2.value + variance);
    row.statistics->rel_bias2 = Estimate{scale * bias2.value, {}};
    if (const auto& ends = bias2.interval)
        row.statistics->rel_bias2->interval = Interval{scale * ends->lo, scale * ends->hi};
    return row;
}

TEST(ErrorKind, SaysBiasOrNoiseWithTheBound) {
    const auto kind = [](Estimate bias2, double variance) { return error_kind(error_row("photons", bias2, variance)); };
    EXPECT_EQ(kind({0.6, Interval{0.5, 0.7}}, 0.4), "bias: 60 % of the squared error, 50 to 70");
    EXPECT_EQ(kind({0.2, Interval{0.1, 0.3}}, 0.8), "noise; bias is 20 % of the squared error, 10 to 30");
    EXPECT_EQ(kind({0.4, Interval{0.1, 0.7}}, 0.6), "bias and noise; bias is 40 % of the squared error, 10 to 70");
    EXPECT_EQ(kind({0.6, Interval{0.4, 0.9}}, 0.4), "bias and noise; bias is 60 % of the squared error, 40 to 90");
    EXPECT_EQ(kind({0.05, Interval{-0.05, 0.16}}, 0.95), "noise; bias below 16 % of the squared error");
    EXPECT_EQ(kind({-0.1, Interval{-0.2, 0.1}}, 1), "noise; bias below 10 % of the squared error");
    EXPECT_EQ(kind({-0.1, Interval{-0.2, -0.01}}, 1), "bias or noise: not resolved");
    EXPECT_EQ(kind({0.3, Interval{-0.1, 0.7}}, 0.7),
              "bias or noise: not resolved, bias below 70 % of the squared error");
    EXPECT_EQ(kind({0.5, Interval{-1, 2}}, 0.5), "bias or noise: not resolved");
    EXPECT_EQ(kind({0.5, {}}, 0.5), "bias or noise: two seeds would tell");
    EXPECT_EQ(error_kind(TableRow{}), "") << "nothing was judged";
}

// The estimate of an unbiased method's bias is noise.
TEST(ErrorKind, KnowsMethodsThatAreUnbiased) {
    const Estimate bias2{0.6, Interval{0.5, 0.7}};
    TableRow unbiased = error_row("path spp=4", bias2, 0.4);
    unbiased.is_unbiased = true;
    EXPECT_EQ(error_kind(unbiased), "noise: the method is unbiased");
    EXPECT_THAT(error_kind(error_row("photon_mapper k=5", bias2, 0.4)), HasSubstr("bias: 60 %"));
    Analysis analysis;
    analysis.rows = {unbiased, error_row("photon_mapper k=5", bias2, 0.4)};
    EXPECT_THAT(markdown_table(analysis), AllOf(HasSubstr("| 0 (unbiased) |"), HasSubstr("| 60 (50 to 70) |")));
}

TEST(LookWords, TheBestComesFirstAndIncompleteOnesLast) {
    std::vector<Cell> cells;
    for (const auto& [method, c] : {std::pair("good", 4e-4), {"best", 1e-4}, {"incomplete", 1e-5}})
        for (std::uint64_t seed = 1; seed <= 3; ++seed)
            cells.push_back(run_of(method, c * (1 + 0.01 * static_cast<double>(seed)), 1, 1, 0, seed));
    Analysis analysis = analysis_of(cells);
    TableRow& incomplete = *std::find_if(analysis.rows.begin(), analysis.rows.end(),
                                         [](const TableRow& r) { return r.method == "incomplete"; });
    incomplete.effects_missing = {Effect::refraction, Effect::caustics};
    incomplete.footing = Footing{{1, {}}, 1, {0.012, Interval{0.009, 0.015}}, FootingVerdict::differs};
    for (EqualTimeLook& look : analysis.looks) {
        look.flip = 0.0625;
        look.passes = 4;
        look.seconds = 1.5;
    }
    const auto words = scene_look(analysis, "box").methods;
    ASSERT_EQ(words.size(), 3u);
    EXPECT_EQ(words[0].look.method, "best");
    EXPECT_EQ(words[0].standing, Standing::best);
    EXPECT_EQ(words[0].beside, "best");
    EXPECT_EQ(line_of(words[0].error), "1.01");
    EXPECT_EQ(line_of(words[0].flip), "0.0625");
    EXPECT_EQ(words[0].shown, "4 passes, 1.50 s");
    EXPECT_EQ(words[1].look.method, "good");
    EXPECT_EQ(words[2].energy, "total");
    EXPECT_EQ(words[2].missing, "refraction, caustics");
    for (TableRow& row : analysis.rows)
        row.noise_floor = 0.0009;
    EXPECT_EQ(line_of(scene_look(analysis, "box").methods[1].error), "below 3.00, not resolved");
}

// The same state has the same words in every place: "not resolved" if the reference hides it, else "not reached".
TEST(Times, NotReachedIsNotUnresolved) {
    TableRow r = error_row("path", {0, {}}, 1);
    EXPECT_EQ(time_field(r, 3).state, State::not_reached);
    r.noise_floor = 0.0001;
    EXPECT_EQ(time_field(r, 3).state, State::not_resolved) << "1 % is not above the floor";
    EXPECT_EQ(time_field(r, 1).state, State::not_reached);
    Analysis analysis;
    analysis.rows = {r};
    EXPECT_THAT(markdown_table(analysis),
                HasSubstr("| not reached | not reached | not reached | not resolved | not resolved |"));
    EXPECT_EQ(field_of(error_table(analysis), "seconds_to_1pct_state"), "not resolved");
}

/// A row of a method whose squared errors are c / t, and differ from seed to seed by a few percent.
TableRow law_row() {
    std::vector<Cell> cells;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        cells.push_back(run_of("path", 0.01 * (1 + 0.02 * static_cast<double>(seed)), 1, 64, 0, seed));
    return analysis_of(cells).rows.front();
}

// table.csv holds no time that the report does not extrapolate to.
TEST(Times, TheNextHalvingOfTableCsvIsThatOfTheReport) {
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
    EXPECT_EQ(in_csv("next_halving"), csv_number(halving.value));
    EXPECT_NE(in_csv("next_halving_hi"), "");
    EXPECT_EQ(in_csv("seconds_to_1pct_state"), "extrapolated");
    EXPECT_EQ(in_csv("seconds_to_1pct"), "") << "never reached is empty";
    EXPECT_NEAR(std::stod(in_csv("seconds_to_1pct_law")), 106, 0.1);
    r.law->misfit = 0.9;
    EXPECT_EQ(next_halving_field(r).state, State::none) << "the law does not hold";
    EXPECT_EQ(in_csv("next_halving"), "");
}

TEST(Times, ASlopeStandsBesideTheFloorOfItsLaw) {
    Analysis analysis;
    analysis.rows = {law_row()};
    PriceLaw& law = *analysis.rows[0].law;
    law.slope = {1.25, Interval{1.2, 1.3}};
    law.floorless_slope = {0.75, Interval{0.7, 0.8}};
    EXPECT_THAT(markdown_table(analysis), AllOf(HasSubstr("| 1.25 ("), Not(HasSubstr("| 0.750 ("))));
    analysis.rows[0].is_unbiased = true;
    EXPECT_THAT(markdown_table(analysis), AllOf(HasSubstr("0 (unbiased)"), HasSubstr("| 0.750 (")));
}

TEST(Times, ASlopeThatThePointsDoNotDetermineIsNotPrinted) {
    TableRow r = law_row();
    EXPECT_EQ(slope_field(r).state, State::measured);
    r.law->misfit = 0.6;
    EXPECT_EQ(slope_field(r).state, State::cannot_be_told) << "the law misses a point by 60 %";
    r.law->misfit = 0;
    r.law->slope = {4, {}};
    EXPECT_EQ(slope_field(r).state, State::cannot_be_told) << "five seeds, and no interval";
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
