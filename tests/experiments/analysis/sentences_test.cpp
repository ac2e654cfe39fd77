// Sentences that say no more than their numbers: each test builds the situation in which one used to say too much.

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/warnings.h"
#include "experiments/report/report.h"
#include "experiments/report/report_data.h"
#include "experiments/report/tables.h"
#include "experiments/report/words.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/csv_reader.h"
#include "tests/support/matchers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace gib::test::sentences_test {
namespace {

/// `seeds` runs of run_of() whose errors differ by a few percent from seed to seed.
std::vector<Cell> runs(const std::string& method, double c, double first, double last, double floor = 0,
                       int seeds = 4) {
    std::vector<Cell> cells;
    for (int seed = 1; seed <= seeds; ++seed)
        cells.push_back(run_of(method, c * (1 + 0.02 * (seed - 0.5 * (seeds + 1))), first, last, floor,
                               static_cast<std::uint64_t>(seed)));
    return cells;
}

std::vector<Cell> joined(std::initializer_list<std::vector<Cell>> lists) {
    std::vector<Cell> all;
    for (const auto& list : lists)
        all.insert(all.end(), list.begin(), list.end());
    return all;
}

// The photon mappers' first images are better than all that the path tracer has, but come after its whole time.
TEST(EqualTimeLooks, MethodsWithoutAnImageStandLast) {
    const Analysis analysis = analysis_of(
        joined({runs("late", 1e-5, 5.98, 12), runs("path", 1e-2, 0.05, 0.85), runs("later", 1e-5, 43.5, 50)}));
    const SceneLook look = scene_look(analysis, "box");
    const auto& words = look.methods;
    ASSERT_EQ(words.size(), 3u);
    EXPECT_EQ(words[0].look.method, "path") << "it alone has kept the time";
    EXPECT_EQ(words[0].standing, Standing::best);
    EXPECT_EQ(words[1].look.method, "late");
    EXPECT_EQ(line_of(words[1].error), "no image yet; first after 5.98 s");
    EXPECT_EQ(words[1].standing, Standing::no_image);
    EXPECT_EQ(line_of(words[2].error), "no image yet; first after 43.5 s");
    EXPECT_EQ(look.seconds, 0.8) << "all are compared at one time";
}

// Four times as many samples of the path tracer would have won.
TEST(Crossovers, NoMethodWinsBecauseTheOtherWasNotRunLonger) {
    const Analysis cut =
        analysis_of(joined({runs("path", 1e-2, 0.01, 0.16, 0, 2), runs("vcm", 2e-2, 0.05, 0.8, 0, 2)}));
    for (const Crossover& c : crossovers(cut))
        EXPECT_NE(c.method, "vcm");
    EXPECT_TRUE(crossovers(cut).back().ends);
    EXPECT_THAT(markdown_table(cut), HasSubstr("`path` was not run longer"));
    const Analysis whole =
        analysis_of(joined({runs("path", 1e-2, 0.01, 0.64, 0, 2), runs("vcm", 2e-2, 0.05, 0.8, 0, 2)}));
    for (const Crossover& c : crossovers(whole))
        EXPECT_NE(c.method, "vcm");
}

// A law with an interval may speak where the run has ended: the floor of the quick method is known.
TEST(Crossovers, ALawSpeaksPastTheEndOfARun) {
    const Analysis analysis = analysis_of(joined({runs("quick", 1e-3, 0.5, 32, 9e-4), runs("exact", 4e-2, 0.5, 256)}));
    const auto changes = crossovers(analysis);
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[1].method, "exact");
    EXPECT_GT(changes[1].seconds, 32);
    EXPECT_FALSE(changes[1].ends);
}

// The slow method's run ends in the middle of the time in which the other one is the best.
TEST(Crossovers, NameRivalsThatEndedDuringAReign) {
    const Analysis analysis =
        analysis_of(joined({runs("long", 1e-3, 0.5, 64, 0, 2), runs("short", 2e-3, 0.5, 8, 0, 2)}));
    const auto changes = crossovers(analysis);
    ASSERT_EQ(changes.size(), 1u);
    EXPECT_EQ(changes[0].method, "long");
    EXPECT_THAT(changes[0].doubts.open, ElementsAre("short"));
    EXPECT_THAT(markdown_table(analysis), HasSubstr("not run longer: `short`"));
}

// The second method's first image is better than all that the first one has.
TEST(Crossovers, ATimeWithoutScatterHasNoInterval) {
    const auto changes = crossovers(analysis_of(joined({runs("early", 1e-1, 0.5, 64), runs("late", 1e-4, 8, 64)})));
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_NEAR(changes[1].seconds, 8, 1e-6);
    EXPECT_FALSE(changes[1].interval);
}

// Noisy seeds: 3.8 % beside 21 % is no tie, 3.8 % beside 4 % is one.
TEST(Ties, AreOfNumbersThatAreClose) {
    const auto beside = [](double error) {
        std::vector<Cell> cells;
        for (const auto& [seed, f] : {std::pair<std::uint64_t, double>{1, 0.8}, {2, 1.25}, {3, 0.9}}) {
            cells.push_back(run_of("best", 0.038 * 0.038 * f, 1, 1, 0, seed));
            cells.push_back(run_of("other", error * error * f, 1, 1, 0, 4 - seed));
        }
        return scene_look(analysis_of(cells), "box").methods.at(1).beside;
    };
    EXPECT_EQ(beside(0.21), "");
    EXPECT_EQ(beside(0.04), "tie with the best");
}

TEST(Verdicts, TheClosestInAFewWordsHasItsTies) {
    const Analysis analysis = analysis_of(joined({runs("a", 1e-1, 0.5, 8), runs("b", 1.001e-1, 0.5, 8)}));
    EXPECT_THAT(cheapest(analysis, "box", 3).detail, AllOf(HasSubstr("closest: a"), HasSubstr("tie with 'b'")));
}

// The box on top of the report says of which error the reference is the limit.
TEST(Verdicts, NotResolvedInAFewWordsNamesWhatTheReferenceResolves) {
    Analysis analysis = analysis_of(runs("a", 1e-2, 0.5, 64));
    analysis.references.push_back({.scene = "box", .method = "path", .noise_floors = {{Layer::total, 4e-4}}});
    const ShortAnswer answer = cheapest(analysis, "box", 3);
    EXPECT_EQ(answer.method, "not resolved");
    EXPECT_THAT(answer.detail, HasSubstr("the reference resolves 2.00 %"));
}

// One group of 16 has met a bright pixel. The reference's variance is as uncertain as it is large, and so is every error
// from which it is subtracted.
TEST(NoiseFloor, KnowsThatTheReferencesOwnErrorIsUncertain) {
    const auto least = [](float bright) {
        std::mt19937 random(3);
        std::normal_distribution<float> noise(1, 0.1f);
        std::vector<Image> groups;
        for (int g = 0; g < 16; ++g) {
            Image image(16, 16);
            for (float& value : image.rgb)
                value = noise(random);
            if (g == 7) image.set(100, Color::Constant(bright));
            groups.push_back(std::move(image));
        }
        const ReferenceLayer layer = layer_of_groups(std::move(groups));
        const Denominators denominators(layer, 0.01);
        return std::pair(least_resolved(layer, denominators),
                         std::pow(relative_standard_error(layer, denominators), 2));
    };
    const auto [even, even_error2] = least(1);
    EXPECT_LT(even, even_error2);
    const auto [uneven, error2] = least(300);
    EXPECT_GT(error2, 4 * even_error2) << "the bright pixel is most of the reference's error";
    EXPECT_GT(uneven, error2);
}

TEST(Floor, ABiasThatMayBeNoneIsAnUpperBound) {
    Analysis analysis = analysis_of(runs("quick", 1e-3, 0.5, 64, 9e-4));
    TableRow& row = analysis.rows[0];
    const auto bias = [&](double value, double lo, double hi) {
        row.statistics->rel_bias2 = Estimate{value, Interval{lo, hi}};
        return line_of(floor_bias_field(row));
    };
    EXPECT_EQ(bias(-1e-5, -1e-4, 1e-4), "below 1.00");
    EXPECT_EQ(bias(4e-4, 1e-4, 8.1e-4), "2.00 (1.00 to 2.85)");
    EXPECT_EQ(bias(4e-4, -1e-3, 2e-3), "cannot be told");
}

TEST(Verdicts, AMethodWhoseRivalEndedIsOnlyTheFirstSeen) {
    const Analysis analysis =
        analysis_of(joined({runs("path", 1e-3, 0.01, 0.16, 0, 2), runs("vcm", 2e-3, 0.05, 3.2, 0, 2)}));
    const VerdictRow first = verdict(analysis, "box")[0];
    EXPECT_EQ(first.method, "vcm");
    EXPECT_EQ(first.remark, "first that was seen to reach it, not run longer: `path`");
    EXPECT_THAT(cheapest(analysis, "box", 1).detail, HasSubstr("not run longer: 'path'"));
}

// Seed by seed both take the same times, in another order.
TEST(Verdicts, EqualMethodsAreATie) {
    std::vector<Cell> cells;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        cells.push_back(run_of("a", 1e-2 * (1 + 0.1 * static_cast<double>(seed)), 0.5, 64, 0, seed));
        cells.push_back(run_of("b", 1.02e-2 * (1.5 - 0.1 * static_cast<double>(seed)), 0.5, 64, 0, seed));
    }
    const Analysis analysis = analysis_of(cells);
    EXPECT_THAT(verdict(analysis, "box")[0].remark, HasSubstr("tie with `"));
    EXPECT_EQ(verdict(analysis, "box")[1].remark, "tie with the best");
    EXPECT_THAT(cheapest(analysis, "box", 1).detail, HasSubstr("tie with"));
    const auto words = scene_look(analysis, "box").methods;
    EXPECT_THAT(words[0].beside, HasSubstr("tie with"));
    EXPECT_EQ(words[1].standing, Standing::tie);
    for (const EqualTimeRow& row : equal_time_rows(analysis))
        EXPECT_EQ(row.ranking[1].standing, Standing::tie);
    for (const Crossover& c : crossovers(analysis))
        EXPECT_EQ(c.doubts.ties.size(), 1u);
    for (const FrontierPoint& p : pareto_frontier(analysis))
        EXPECT_EQ(p.doubts.ties.size(), 1u);
}

// The budget ends the seeds after 40 and 64 s. Their errors there, and not those at the last pass that all have, are the
// ends of the curve and of the law.
TEST(Curves, EndWhereTheTableEnds) {
    std::vector<Cell> cells = {run_of("path", 0.64, 1, 32, 0, 1), run_of("path", 0.64, 1, 64, 0, 2)};
    cells[0].checkpoints.push_back(checkpoint_of(40, 40, 0.64 / 40));
    Analysis analysis = analysis_of(cells);
    const double error2 = (0.64 / 40 + 0.64 / 64) / 2;
    const auto curve = mean_curve(cells_by_method(analysis, "box").at("path"), Layer::total);
    EXPECT_EQ(curve.back().seconds, 52);
    EXPECT_EQ(curve.back().least_passes, 40u);
    EXPECT_EQ(curve.back().most_passes, 64u);
    analysis.references.push_back({.scene = "box", .method = "path"});
    for (CellCheckpoint& c : analysis.cells[0].checkpoints)
        c.errors[Layer::total].mse_corrected = 1;
    for (CellCheckpoint& c : analysis.cells[1].checkpoints)
        c.errors[Layer::total].mse_corrected = 1;
    const auto points = report_data(analysis)["scenes"]["box"]["curves"]["total"][0]["points"];
    EXPECT_NEAR(points.back()[2].get<double>(), std::sqrt(error2), 1e-9);
    analysis.rows[0].least_passes = 40;
    analysis.rows[0].most_passes = 64;
    EXPECT_EQ(field_of(error_table(analysis), "passes"), "40 to 64");
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| 40 to 64 |"));
}

// The mean error of the final images is 4.8 %, but one of the seeds stands at 5.6 %.
TEST(Times, SayThatNotAllSeedsHaveReachedAnError) {
    std::vector<Cell> cells;
    for (const auto& [seed, c] : {std::pair<std::uint64_t, double>{1, 0.1}, {2, 0.1}, {3, 0.2}})
        cells.push_back(run_of("path", c, 1, 64, 0, seed));
    const Analysis analysis = analysis_of(cells);
    ASSERT_LT(analysis.rows[0].statistics->rel_mse_corrected, 0.0025);
    EXPECT_EQ(line_of(time_field(analysis.rows[0], 1)), "not by all seeds (by 2 of 3)");
    EXPECT_EQ(field_of(error_table(analysis), "seconds_to_5pct"), "");
    EXPECT_EQ(field_of(error_table(analysis), "seconds_to_5pct_state"), "some seeds");
}

TEST(Bias, AClippedEstimateIsAnUpperBound) {
    TableRow row = row_of("photon_mapper", Layer::total, Estimate{-0.05, Interval{-0.2, 0.171}}, 4);
    row.statistics->rel_bias2 = row.statistics->bias2;
    row.statistics->rel_mse_corrected = 0.9;  // of which 0.95 is variance
    EXPECT_EQ(line_of(bias_share_field(row), " %"), "below 18 %");
    EXPECT_EQ(line_of(bias2_field(row)), "below 0.171");
    row.is_unbiased = true;
    EXPECT_EQ(line_of(bias_share_field(row)), "0 (unbiased)");
}

// The absolute error is that of the lamp's edge, which is noise; the relative one that stands beside the words is bias.
TEST(Bias, IsAShareOfTheRelativeErrorThatStandsBesideIt) {
    TableRow row = row_of("radiosity", Layer::total, Estimate{1, Interval{-3, 5}}, 4);
    row.statistics->variance = Estimate{9, {}};
    row.statistics->rel_bias2 = Estimate{0.0036, Interval{0.0030, 0.0042}};
    row.statistics->rel_mse_corrected = 0.0045;
    EXPECT_EQ(error_kind(row), "bias: 80 % of the squared error, 67 to 93");
}

TEST(Bias, WhoseWholeIntervalIsBelowZeroTellsNothing) {
    TableRow row = row_of("photon_mapper", Layer::total, Estimate{-0.05, Interval{-0.08, -0.02}}, 2);
    row.statistics->rel_bias2 = row.statistics->bias2;
    EXPECT_EQ(line_of(bias2_field(row)), "cannot be told");
    EXPECT_EQ(error_kind(row), "bias or noise: not resolved");
}

TEST(Bias, UnbiasedMethodsHaveNoCurveOfIt) {
    Analysis analysis = analysis_of(runs("path", 1e-2, 1, 8));
    analysis.references.push_back({.scene = "box", .method = "path"});
    analysis.rows[0].bias = {{0.1, 1}};
    const auto bias = [&] { return report_data(analysis)["scenes"]["box"]["spectra"]["total"][0]["bias"].size(); };
    EXPECT_EQ(bias(), 1u);
    analysis.rows[0].is_unbiased = true;
    EXPECT_EQ(bias(), 0u);
}

// A fixed map's floor of 7 % does not show in a run that ends at 10 %: the fitted one is 0 without any scatter.
TEST(Extrapolation, AFloorThatIsNotSeenIsNotKnownToBeNone) {
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    std::vector<Cell> cells;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        cells.push_back(run_of("photon_mapper", 0.06 * (1 + 0.05 * normal(random)), 1, 16, 0.0049, seed));
        for (CellCheckpoint& c : cells.back().checkpoints)
            c.errors[Layer::total].rel_mse_corrected *= 1 + 0.1 * normal(random);
    }
    const Analysis analysis = analysis_of(cells);
    const Field time = time_field(analysis.rows[0], 1);
    EXPECT_NE(time.state, State::extrapolated) << line_of(time);
}

// Points that scatter about a law may lie below its floor.
TEST(Extrapolation, NoFloorIsAboveTheErrorOfItsRow) {
    Analysis analysis = analysis_of(runs("quick", 1e-3, 0.5, 64, 9e-4));
    ASSERT_EQ(time_field(analysis.rows[0], 3).state, State::never);
    analysis.rows[0].statistics->rel_mse_corrected = 8e-4;
    EXPECT_EQ(time_field(analysis.rows[0], 3).state, State::not_reached);
}

Cell busy(Cell cell, double waiting) {
    cell.processor_seconds = 2 * cell.last().seconds;
    cell.waiting_seconds = waiting * cell.processor_seconds;
    return cell;
}

// The lamp is 6.5 % of the error in each of the images, and no seed has met it; all else is noise that falls.
TEST(Extrapolation, ARunThatStandsAtUnmetLightHasNoTimeBelowIt) {
    Analysis analysis = analysis_of(runs("path", 1e-3, 0.5, 64, 0.00425));
    TableRow& row = analysis.rows[0];
    row.is_unbiased = true;
    EXPECT_EQ(time_field(row, 1).state, State::not_reached) << "5 %, by the curve alone";
    EXPECT_EQ(next_halving_field(row).state, State::none);
    Analysis above = analysis_of(runs("path", 1e-1, 0.5, 16, 0.005));
    above.rows[0].is_unbiased = true;
    EXPECT_GE(time_field(above.rows[0], 0).interval->hi, 0.1 / (0.01 - 0.005))
        << "10 %, whose square is twice the floor";
}

// error^2 = t^-1.5 by the first points, because rare paths are still to come, or by a sequence that cannot keep this up.
TEST(Extrapolation, NoErrorFallsFasterThanThatOfIndependentSamples) {
    std::vector<Cell> cells;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        Cell& cell = cells.emplace_back(cell_of("path", seed));
        for (std::uint32_t passes = 1; passes <= 16; passes *= 2)
            cell.checkpoints.push_back(checkpoint_of(
                passes, passes, (1 + 0.02 * static_cast<double>(seed)) * std::pow(static_cast<double>(passes), -1.5)));
    }
    Analysis analysis = analysis_of(cells);
    TableRow& row = analysis.rows[0];
    row.is_unbiased = true;
    const Field five = time_field(row, 1);  // the square of 12.8 % after 16 s
    ASSERT_EQ(five.state, State::extrapolated);
    EXPECT_NEAR(five.value, 16 * (1.05 / 64) / 0.0025, 2);
    EXPECT_LT(five.interval->lo, 1.02 * std::pow(1.05 / 0.0025, 1 / 1.5)) << "it may go on as it was";
}

// Noise still hides the floor; the images tell of it.
TEST(Extrapolation, UnmetLightIsAFloorThatNoCurveShows) {
    Analysis analysis = analysis_of(runs("path", 1, 0.5, 32));
    TableRow& row = analysis.rows[0];
    row.is_unbiased = true;
    EXPECT_EQ(time_field(row, 1).state, State::extrapolated);
    EXPECT_EQ(time_field(row, 0).state, State::extrapolated);
    row.unmet = 0.00425;
    const Field ten = time_field(row, 0), five = time_field(row, 1);
    EXPECT_EQ(ten.state, State::at_least) << "10 %, not far above it";
    EXPECT_EQ(line_of(five), line_of(ten)) << "5 % is not reached earlier, and nothing else is known";
    EXPECT_THAT(error_kind(row), HasSubstr("noise: the method is unbiased; 14 % of the squared error is light that"));
    row.statistics->variance = Estimate{1, {}};
    EXPECT_EQ(line_of(variance_field(row)), "cannot be told");
}

// The better label's run ended before that of the path tracer, so that it does not count for the best, but it is the better one.
TEST(Verdicts, ShowTheBestLabelOfEachOtherMethod) {
    const Analysis analysis =
        analysis_of(joined({runs("path", 1e-2, 0.5, 8), runs("photon_mapper photons=1000", 1e-2, 0.5, 16, 0.03),
                            runs("photon_mapper photons=30000", 1e-2, 0.5, 4, 0.01)}));
    std::vector<std::string> methods;
    for (const VerdictRow& row : verdict(analysis, "box"))
        if (row.target == 3) methods.push_back(row.method);
    EXPECT_THAT(methods, ::testing::ElementsAre("path", "photon_mapper photons=30000"));
}

// Both seeds reach 5 % with their first images, one of which comes after the mean of the two times.
TEST(Verdicts, TheBestOneHasAnErrorAtItsTime) {
    std::vector<Cell> cells;
    for (const auto& [seed, first] : {std::pair<std::uint64_t, double>{1, 5}, {2, 5.3}})
        cells.push_back(run_of("radiosity", 1e-3, first, 4 * first, 0, seed));
    const auto rows = verdict(analysis_of(cells), "box");
    ASSERT_TRUE(rows[0].is_best);
    EXPECT_EQ(line_of(rows[0].error), "5.00");
}

TEST(Ties, OneSeedTellsNone) {
    const Analysis analysis = analysis_of(joined({runs("path", 1e-2, 1, 8, 0, 1), runs("vcm", 0.2, 1, 8, 0, 1)}));
    const SceneLook look = scene_look(analysis, "box");
    ASSERT_EQ(look.methods.size(), 2u);
    EXPECT_EQ(look.methods[0].beside, "best, one seed does not tell");
    EXPECT_EQ(look.methods[1].beside, "one seed does not tell") << "at 4.5 times the error";
}

// The image of another renderer may be one: at 25 times the error it is no tie with the best.
TEST(Ties, OneSeedOfARivalIsNoTie) {
    const Analysis analysis = analysis_of(joined({runs("path", 1e-2, 1, 8), runs("one", 0.2, 1, 8, 0, 1)}));
    EXPECT_EQ(scene_look(analysis, "box").methods.at(0).beside, "best, one seed does not tell: `one`");
}

TEST(BusyMachine, IsSeenByThreadsThatWait) {
    Analysis analysis = analysis_of(joined({runs("path", 1e-2, 1, 8), runs("vcm", 1e-2, 1, 8)}));
    for (Cell& cell : analysis.cells)
        cell = busy(cell, 0.005);
    EXPECT_FALSE(busy_machine(analysis, "gibench run 'e.toml'"));
    analysis.cells[1] = busy(analysis.cells[1], 0.5);
    const auto warning = busy_machine(analysis, "gibench run 'e.toml'");
    ASSERT_TRUE(warning);
    EXPECT_THAT(warning->sentence,
                AllOf(HasSubstr("path: threads waited 0.5 s for each second"), Not(HasSubstr("vcm"))));
    EXPECT_EQ(warning->command, "gibench run 'e.toml' --only 'path' --fresh");
    analysis.warnings.push_back(*warning);
    const std::string text = markdown_table(analysis);
    EXPECT_LT(text.find("- Warning: the machine was busy"), text.find("## Each method")) << "before any number";
}

TEST(BusyMachine, IsOneWarningForAllScenes) {
    std::vector<Cell> cells = joined({runs("path", 1e-2, 1, 8), runs("vcm", 1e-2, 1, 8)});
    for (std::size_t i = 0, count = cells.size(); i < count; ++i) {
        cells[i] = busy(cells[i], 0.5);
        cells.push_back(cells[i]);
        cells.back().scene = "sky";
    }
    const auto warning = busy_machine(analysis_of(cells), "gibench run 'e.toml'");
    ASSERT_TRUE(warning);
    EXPECT_EQ(warning->scene, "");
    EXPECT_THAT(warning->sentence, AllOf(HasSubstr("box, path: threads waited"), HasSubstr("and 2 more")));
    EXPECT_EQ(warning->command, "gibench run 'e.toml' --fresh");
    Analysis analysis = analysis_of(joined({runs("path", 1e-2, 1, 8), runs("vcm", 1e-2, 1, 8)}));
    for (Cell& cell : analysis.cells)
        cell = busy(cell, 0.5);
    EXPECT_EQ(busy_machine(analysis, "gibench run 'e.toml'")->command, "gibench run 'e.toml' --only 'box' --fresh");
}

// After 16 passes each, the slow method has half of the error; after the fast one's time it has no image.
TEST(EqualPasses, AreComparedWhereTimesAreNotEqualOrTooLong) {
    Analysis analysis = analysis_of(joined({runs("fast", 4e-4, 0.01, 0.16), runs("slow", 1e-2, 1, 16)}));
    const std::string head = "scenes = ['box.xml']\n", methods = "[[method]]\nname = 'path'\n",
                      row = "| box | total | 16 | slow | 2.50 |  | fast: 2.00 |";
    for (const std::string budget : {"", "[budget]\npasses = 16\n"}) {
        analysis.index.experiment_text = head + budget + methods;
        const std::string text = markdown_table(analysis);
        EXPECT_THAT(text, HasSubstr(row));
        EXPECT_THAT(text, AllOf(HasSubstr("## At equal passes"), Not(HasSubstr("## At equal time"))));
    }
    analysis.index.experiment_text = head + "[budget]\nseconds = 16\n" + methods;
    EXPECT_THAT(markdown_table(analysis), Not(HasSubstr("## At equal passes")));
    for (Cell& cell : analysis.cells)
        cell = busy(cell, 0.5);
    EXPECT_THAT(markdown_table(analysis), HasSubstr(row));
}

TEST(BusyMachine, IsSeenBySeedsWhosePassesTakeLonger) {
    std::vector<Cell> cells = runs("path", 1e-2, 1, 8);
    EXPECT_FALSE(busy_machine(analysis_of(cells), "gibench run 'e.toml'"));
    cells[2] = run_of("path", 1e-2, 1.6, 12.8, 0, 3);
    EXPECT_THAT(busy_machine(analysis_of(cells), "gibench run 'e.toml'")->sentence,
                HasSubstr("a pass takes 1 s to 1.6 s, 8 passes"));
}

}  // namespace
}  // namespace gib::test::sentences_test
