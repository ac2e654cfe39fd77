// Sentences that say no more than their numbers: each test builds the situation in which one used to say too much.

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/row_fields.h"
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

// A law with an interval may speak where the run has ended: the floor of the quick method is known.
TEST(Crossovers, ALawSpeaksPastTheEndOfARun) {
    const Analysis analysis = analysis_of(joined({runs("quick", 1e-3, 0.5, 32, 9e-4), runs("exact", 4e-2, 0.5, 256)}));
    const auto changes = crossovers(analysis);
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[1].method, "exact");
    EXPECT_GT(changes[1].seconds, 32);
    EXPECT_FALSE(changes[1].ends);
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
    EXPECT_EQ(beside(0.04), "not significantly different from the best");
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

// The lamp is 6.5 % of the error in each of the images, and no seed has met it; all else is noise that falls.
TEST(Extrapolation, ARunThatStandsAtUnsampledLightHasNoTimeBelowIt) {
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

// The curve still falls like noise; the images show the unsampled light, which is an error floor.
TEST(Extrapolation, UnsampledLightIsAFloorThatNoCurveShows) {
    Analysis analysis = analysis_of(runs("path", 1, 0.5, 32));
    TableRow& row = analysis.rows[0];
    row.is_unbiased = true;
    EXPECT_EQ(time_field(row, 1).state, State::extrapolated);
    EXPECT_EQ(time_field(row, 0).state, State::extrapolated);
    row.unsampled = 0.00425;
    const Field ten = time_field(row, 0), five = time_field(row, 1);
    EXPECT_EQ(ten.state, State::at_least) << "10 %, not far above it";
    EXPECT_EQ(line_of(five), line_of(ten)) << "5 % is not reached earlier, and nothing else is known";
    EXPECT_EQ(error_kind(row), "noise, 14 % unsampled light");
    row.statistics->variance = Estimate{1, {}};
    EXPECT_EQ(line_of(variance_field(row)), "inconclusive");
}

// Both seeds reach 5 % with their first images. One image is later than the mean of the two times.
TEST(Verdicts, TheBestOneHasAnErrorAtItsTime) {
    std::vector<Cell> cells;
    for (const auto& [seed, first] : {std::pair<std::uint64_t, double>{1, 5}, {2, 5.3}})
        cells.push_back(run_of("radiosity", 1e-3, first, 4 * first, 0, seed));
    const auto rows = verdict(analysis_of(cells), "box");
    ASSERT_TRUE(rows[0].is_best);
    EXPECT_EQ(line_of(rows[0].error), "5.00");
}

TEST(Ties, OneSeedIsInconclusive) {
    const Analysis analysis = analysis_of(joined({runs("path", 1e-2, 1, 8, 0, 1), runs("vcm", 0.2, 1, 8, 0, 1)}));
    const SceneLook look = scene_look(analysis, "box");
    ASSERT_EQ(look.methods.size(), 2u);
    EXPECT_EQ(look.methods[0].beside, "best, inconclusive: one seed");
    EXPECT_EQ(look.methods[1].beside, "inconclusive: one seed") << "at 4.5 times the error";
}

// The image of another renderer may be one: at 25 times the error it is no tie with the best.
TEST(Ties, OneSeedOfARivalIsNoTie) {
    const Analysis analysis = analysis_of(joined({runs("path", 1e-2, 1, 8), runs("one", 0.2, 1, 8, 0, 1)}));
    EXPECT_EQ(scene_look(analysis, "box").methods.at(0).beside, "best, inconclusive, one seed: `one`");
}

// Its true error may be the one that was asked for: that it takes longer is inconclusive.
TEST(Ties, WhoMayHaveReachedAnErrorIsNotBehind) {
    Analysis analysis = analysis_of(joined({runs("quick", 1e-3, 0.5, 8), runs("close", 2.6e-2, 0.5, 8)}));
    const auto standing = [&](double lowest) {
        const auto row = std::ranges::find(analysis.rows, "close", &TableRow::method);
        auto& statistics = *row->statistics;
        statistics.rel_mse.interval = Interval{statistics.rel_mse.value - statistics.rel_mse_corrected + lowest, 1};
        return of_method(Contest(analysis, "box").to_error(1), "close").standing;  // 5 %
    };
    EXPECT_EQ(standing(2.4e-3), Standing::open);
    EXPECT_EQ(standing(2.6e-3), Standing::behind);
}

}  // namespace
}  // namespace gib::test::sentences_test
