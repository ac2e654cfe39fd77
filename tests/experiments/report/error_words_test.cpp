// The words about bias and noise, about what is left out, and about times that were not reached.
#include "experiments/report/error_words.h"

#include "experiments/report/look_words.h"
#include "experiments/report/price_text.h"
#include "experiments/report/report.h"
#include "experiments/report/tables.h"

#include <gmock/gmock.h>

namespace gib::test::error_words_test {
namespace {

using ::testing::HasSubstr;

/// A row of images with these parts of the mean squared error.
TableRow row(const std::string& method, Estimate bias2, double variance) {
    TableRow row;
    row.scene = "box";
    row.method = method;
    row.component = total_name;
    row.statistics = ReplicateStatistics{5, {1, {}}, {1, {}}, {0.01, {}}, 0.1, 0.01, bias2, Estimate{variance, {}}, {}};
    return row;
}

TEST(ErrorKind, SaysBiasOrNoiseWithTheBound) {
    const auto kind = [](Estimate bias2, double variance) { return error_kind(row("photons", bias2, variance)); };
    EXPECT_EQ(kind({0.6, Interval{0.5, 0.7}}, 0.4), "bias: 60 % of the squared error, 50 to 70");
    EXPECT_EQ(kind({0.2, Interval{0.1, 0.3}}, 0.8), "noise; bias is 20 % of the squared error, 10 to 30");
    EXPECT_EQ(kind({0.05, Interval{-0.05, 0.16}}, 0.95), "noise; bias below 16 % of the squared error");
    EXPECT_EQ(kind({-0.1, Interval{-0.2, 0.1}}, 1), "noise; bias below 10 % of the squared error");
    EXPECT_EQ(kind({0.3, Interval{-0.1, 0.7}}, 0.7),
              "bias or noise: not resolved, bias below 70 % of the squared error");
    EXPECT_EQ(kind({0.5, Interval{-1, 2}}, 0.5), "bias or noise: not resolved");
    EXPECT_EQ(kind({0.5, {}}, 0.5), "bias or noise: two seeds would tell");
    EXPECT_EQ(error_kind(TableRow{}), "") << "nothing was judged";
}

// The estimate of an unbiased method's bias is noise.
TEST(ErrorKind, KnowsMethodsThatAreUnbiased) {
    const Estimate bias2{0.6, Interval{0.5, 0.7}};
    TableRow unbiased = row("path spp=4", bias2, 0.4);
    unbiased.is_unbiased = true;
    EXPECT_EQ(error_kind(unbiased), "noise: the method is unbiased");
    EXPECT_THAT(error_kind(row("photon_mapper k=5", bias2, 0.4)), HasSubstr("bias: 60 %"));
    Analysis analysis;
    analysis.rows = {unbiased, row("photon_mapper k=5", bias2, 0.4)};
    EXPECT_THAT(markdown_table(analysis),
                ::testing::AllOf(HasSubstr("| none: unbiased |"), HasSubstr("| 60 % bias |")));
}

TEST(LookWords, TheBestComesFirstAndIncompleteOnesLast) {
    Analysis analysis;
    const auto add = [&](const std::string& method, double error2) {
        analysis.rows.push_back(row(method, {0, Interval{-1, 1}}, 1));
        analysis.looks.push_back({.scene = "box", .method = method, .seconds = 2, .error2 = error2, .passes = 4});
        analysis.looks.back().image_seconds = 1.5;
        analysis.looks.back().flip = 0.0625;
    };
    add("good", 0.0004);
    add("best", 0.0001);
    add("incomplete", 0.00001);
    analysis.rows.back().effects_missing = "refraction;caustics";
    analysis.rows.back().footing = Footing{{1, {}}, 1, {0.012, Interval{0.009, 0.015}}, FootingVerdict::differs};
    const auto words = look_words(analysis, "box");
    ASSERT_EQ(words.size(), 3u);
    EXPECT_EQ(words[0].look.method, "best");
    EXPECT_EQ(words[0].error, "1.00");
    EXPECT_EQ(words[0].flip, "0.062");
    EXPECT_EQ(words[0].shown, "4 passes, 1.50 s");
    EXPECT_EQ(words[1].look.method, "good");
    EXPECT_EQ(words[2].energy, "total");
    EXPECT_EQ(words[2].missing, "refraction, caustics");
    analysis.rows[0].noise_floor = 0.0009;
    EXPECT_EQ(look_words(analysis, "box")[1].error, "below 3.00");
}

// The same state has the same words in every place: "not resolved" if the reference hides it, else "not reached".
TEST(Times, NotReachedIsNotUnresolved) {
    TableRow r = row("path", {0, {}}, 1);
    EXPECT_EQ(time_text(r, 3), "not reached");
    r.noise_floor = 0.0001;
    EXPECT_EQ(time_text(r, 3), "not resolved") << "1 % is not above the floor";
    EXPECT_EQ(time_text(r, 1), "not reached");
    Analysis analysis;
    analysis.rows = {r};
    const std::string text = markdown_table(analysis);
    EXPECT_THAT(text, HasSubstr("| not reached | not reached | not reached | not resolved | not resolved |"));
}

// table.csv holds no time that the report does not extrapolate to.
TEST(Times, TheNextHalvingOfTableCsvIsThatOfTheReport) {
    TableRow r = row("path", {0, {}}, 1);
    r.law = PriceLaw{};
    r.law->law = {.floor = 0, .factor = 1, .slope = 1, .start = 0};
    r.law->floorless = r.law->law;
    r.law->first_seconds = 1;
    r.law->last_seconds = 64;
    r.law->next_halving = Estimate{4, Interval{3.5, 4.5}};
    const auto in_csv = [&] {
        Analysis analysis;
        analysis.rows = {r};
        const CsvTable table = error_table(analysis);
        const auto at = std::find(table.columns.begin(), table.columns.end(), "next_halving") - table.columns.begin();
        return table.rows.at(0).at(static_cast<std::size_t>(at));
    };
    EXPECT_EQ(next_halving_text(r), "4.00 (3.50 to 4.50)");
    EXPECT_EQ(in_csv(), "4");
    r.law->misfit = 0.9;
    EXPECT_EQ(next_halving_text(r), "") << "the law does not hold";
    EXPECT_EQ(in_csv(), "");
    r.law->misfit = 0;
    r.law->next_halving.reset();  // a floor that is not resolved
    EXPECT_EQ(in_csv(), "");
    r.law->next_halving = Estimate{1000, {}};
    EXPECT_EQ(in_csv(), "") << "too far to be extrapolated";
}

}  // namespace
}  // namespace gib::test::error_words_test
