// Two runs of an experiment: equal ones do not differ significantly, unequal ones do, and runs that cannot be compared
// are named with the reason.

#include "experiments/program/run_comparison.h"

#include "experiments/report/words.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/matchers.h"

#include <cmath>
#include <random>
#include <sstream>

namespace gib::test::run_comparison_test {
namespace {

/// A run of three methods with skewed errors of unlike scatter, and times that scatter by 3 %. `slower` and
/// `noisier` are factors of the first method's time and squared error.
Analysis simulated_run(int seeds, std::mt19937_64& random, double slower = 1, double noisier = 1) {
    std::normal_distribution<double> normal;
    std::vector<Cell> cells;
    for (const auto& [method, sigma] : {std::pair("a", 0.1), {"b", 0.3}, {"c", 0.8}})
        for (int seed = 1; seed <= seeds; ++seed) {
            const bool is_changed = std::string(method) == "a";
            const double level = std::exp(sigma * normal(random) - 0.5 * sigma * sigma) * (is_changed ? noisier : 1);
            const double pass = 0.25 * (1 + 0.03 * normal(random)) * (is_changed ? slower : 1);
            Cell cell = cell_of(method, static_cast<std::uint64_t>(seed));
            for (int i = 0; i <= 6; ++i)
                cell.checkpoints.push_back(
                    checkpoint_of(1u << i, pass * std::ldexp(1, i), 4e-3 * level / std::ldexp(0.25, i)));
            cells.push_back(std::move(cell));
        }
    return analysis_of(cells);
}

std::size_t count_of(const RunComparison& comparison, ChangeVerdict verdict, const std::string& method = "") {
    return static_cast<std::size_t>(
        std::count_if(comparison.changes.begin(), comparison.changes.end(), [&](const Change& change) {
            return change.verdict == verdict && (method.empty() || change.method == method);
        }));
}

// The promise is 5 % of the pairs, for all their numbers together. Of 200 pairs with 5 %, 16 or fewer differ
// significantly with a probability of 98 %.
TEST(CompareRuns, EqualRunsAreNotToldApart) {
    for (const int seeds : {2, 3, 5}) {
        std::mt19937_64 random(static_cast<std::uint64_t>(71 + seeds));
        int different = 0;
        for (int pair = 0; pair < 200; ++pair) {
            const Analysis before = simulated_run(seeds, random), after = simulated_run(seeds, random);
            const RunComparison comparison = compare_runs(before, after);
            ASSERT_GE(comparison.changes.size(), 6u);
            different += count_of(comparison, ChangeVerdict::better) + count_of(comparison, ChangeVerdict::worse) > 0;
        }
        EXPECT_LE(different, 16) << seeds << " seeds";
    }
}

TEST(CompareRuns, AMethodThatTakesTwiceAsLongIsWorse) {
    std::mt19937_64 random(5);
    int found = 0, others = 0;
    for (int pair = 0; pair < 20; ++pair) {
        const Analysis before = simulated_run(5, random), after = simulated_run(5, random, 2);
        const RunComparison slower = compare_runs(before, after), faster = compare_runs(after, before);
        found += count_of(slower, ChangeVerdict::worse, "a") > 0 && count_of(faster, ChangeVerdict::better, "a") > 0;
        others += count_of(slower, ChangeVerdict::worse, "b") + count_of(slower, ChangeVerdict::worse, "c") > 0;
    }
    EXPECT_GE(found, 18);
    EXPECT_LE(others, 4);
}

// Equal errors after times that differ by less than machines do.
TEST(CompareRuns, ASlightlySlowerMachineIsNoChange) {
    std::vector<Cell> before, after;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        before.push_back(run_of("a", 4e-3 * (1 + 1e-4 * static_cast<double>(seed)), 0.5, 16, 0, seed));
        after.push_back(before.back());
        for (CellCheckpoint& c : after.back().checkpoints)
            c.checkpoint.seconds *= 1.04;
    }
    const RunComparison comparison = compare_runs(analysis_of(before), analysis_of(after));
    EXPECT_EQ(count_of(comparison, ChangeVerdict::inconclusive), comparison.changes.size());
    EXPECT_GE(comparison.changes.size(), 3u);
}

// The numbers are those of the tables: the root of the mean squared error, and the time to an error as in table.csv.
TEST(CompareRuns, NumbersAndNamesAreThoseOfTheTable) {
    std::mt19937_64 random(9);
    Analysis before = simulated_run(5, random), after = simulated_run(5, random, 1.5);
    for (Analysis* analysis : {&before, &after})
        for (TableRow& row : analysis->rows)
            row.name = "method " + row.method;
    const RunComparison comparison = compare_runs(before, after);
    int of_final_images = 0;
    for (const Change& change : comparison.changes)
        for (const auto& [analysis, value] : {std::pair(&before, change.before), {&after, change.after}}) {
            const TableRow& row = *analysis->row("box", change.method, Layer::total);
            EXPECT_EQ(change.name, row.name);
            if (change.of == Change::Of::seconds) {
                const auto target = std::find(target_errors.begin(), target_errors.end(), change.at);
                const Field time = time_field(row, static_cast<std::size_t>(target - target_errors.begin()));
                EXPECT_NEAR(value, time.value, 1e-9 * value);
            } else if (change.at > row.seconds * (1 - 1e-9)) {
                ++of_final_images;
                EXPECT_NEAR(value, std::sqrt(row.statistics->rel_mse_corrected), 0.03 * value) << change.method;
            }
        }
    EXPECT_GE(of_final_images, 3);
    EXPECT_THAT(change_text(comparison), HasSubstr("box, method a\n"));
}

TEST(CompareRuns, ErrorsBelowTheNoiseFloorAreSaid) {
    std::mt19937_64 random(10);
    Analysis before = simulated_run(5, random), after = simulated_run(5, random, 1, 1e-4);
    for (Analysis* analysis : {&before, &after})
        analysis->references = {{.scene = "box", .method = "path", .noise_floors = {{Layer::total, 1e-6}}}};
    const RunComparison comparison = compare_runs(before, after);
    const Change& error = comparison.changes.front();
    EXPECT_EQ(error.method, "a");
    EXPECT_FALSE(error.before_is_floor);
    EXPECT_TRUE(error.after_is_floor);
    EXPECT_DOUBLE_EQ(error.after, 1e-3);
    EXPECT_EQ(error.verdict, ChangeVerdict::better);
    EXPECT_THAT(change_text(comparison), HasSubstr("better; new raised to the references' noise floor\n"));
    EXPECT_EQ(change_table(comparison).rows.front()[12], "yes");
    EXPECT_THAT(change_text(compare_runs(before, before)), Not(HasSubstr("noise floor")));
}

TEST(CompareRuns, UnlikeQuantitiesAreSaidAndNotCompared) {
    std::mt19937_64 random(8);
    Analysis before = simulated_run(3, random);
    before.index.scenes = {{"box", "box.xml", "hash", "r", "path", 0.01, {}}};
    Analysis after = before;
    ASSERT_FALSE(compare_runs(before, after).changes.empty());
    const auto is_refused = [&](const char* why) {
        const RunComparison comparison = compare_runs(before, after);
        EXPECT_TRUE(comparison.changes.empty()) << why;
        EXPECT_THAT(comparison.remarks, ElementsAre(HasSubstr(why)));
        after = before;
    };
    before.index.epsilon = 0.1;
    after.index.epsilon = 0.001;
    is_refused("box: not compared, because epsilon was 0.1 and is 0.001");
    after.index.definitions = 7;
    is_refused("the definition of errors was version 1 and is version 7");
    after.index.scenes[0].reference_method = "the image r.exr";
    is_refused("the reference was an estimate of gibench and is the image r.exr (r)");
    after.references.push_back({.scene = "box", .method = "path", .unjudged = {Component::caustic}});
    is_refused("the components compared were all and are all but caustic");

    after.index.scenes[0].target = 0.05;
    const RunComparison noted = compare_runs(before, after);
    EXPECT_FALSE(noted.changes.empty()) << "the noise floors allow for it";
    EXPECT_THAT(noted.remarks, ElementsAre("box: the reference was path, target 1 % and is path, target 5 %"));
}

TEST(CompareRuns, BiasAgainstADeclarationIsSaid) {
    std::mt19937_64 random(8);
    const Analysis before = simulated_run(3, random);
    Analysis after = before;
    EXPECT_FALSE(compare_runs(before, after).has_contradictions);
    TableRow& total = after.rows.front();
    TableRow indirect = total;
    total.contradicted_in = {Layer::indirect};
    indirect.layer = Layer::indirect;
    indirect.balance.emplace();
    indirect.balance->energy.value = 0.97;
    indirect.balance->excess = {-0.03, Interval{-0.035, -0.025}};
    after.rows.push_back(indirect);
    const RunComparison comparison = compare_runs(before, after);
    EXPECT_TRUE(comparison.has_contradictions);
    EXPECT_THAT(comparison.remarks,
                ElementsAre("box, a: in the new run biased, although declared unbiased: mean energy relative to the "
                            "reference's `indirect` -3.00 % (-3.50 to -2.50)"));
    EXPECT_EQ(error_kind(after.rows.front()), "bias, although declared unbiased");
}

TEST(CompareRuns, OtherMachinesScenesAndMethodsAreSaid) {
    std::mt19937_64 random(8);
    const Analysis before = simulated_run(3, random, 10);
    Analysis after = simulated_run(3, random);
    for (TableRow& row : after.rows)
        row.cpus = {"another"};
    EXPECT_EQ(count_of(compare_runs(before, after), ChangeVerdict::better), 0u);
    EXPECT_GE(count_of(compare_runs(before, after), ChangeVerdict::other_machine), 6u);

    Analysis renamed = simulated_run(3, random);
    for (TableRow& row : renamed.rows)
        if (row.method == "c") row.method = "d";
    for (Cell& cell : renamed.cells)
        if (cell.method == "c") cell.method = "d";
    EXPECT_THAT(compare_runs(before, renamed).remarks,
                ElementsAre("box, c: only in the old run", "box, d: only in the new run"));

    Analysis old_scene = before, new_scene = before;
    old_scene.index.scenes = {{"box", "box.xml", "hash 1", "r", "path", 0.01, {}}};
    new_scene.index.scenes = {{"box", "box.xml", "hash 2", "r", "path", 0.01, {}}};
    const RunComparison changed = compare_runs(old_scene, new_scene);
    EXPECT_TRUE(changed.changes.empty());
    EXPECT_THAT(changed.remarks, ElementsAre(HasSubstr("has changed")));
    EXPECT_THAT(change_text(changed), HasSubstr("nothing to compare"));
}

void rename(Analysis& analysis, const std::string& method, const std::string& label, const std::string& name) {
    for (TableRow& row : analysis.rows)
        if (row.method == method) {
            row.method = label;
            row.name = name;
        }
    for (Cell& cell : analysis.cells)
        if (cell.method == method) cell.method = label;
    std::ranges::replace(analysis.index.methods, method, label);
}

TEST(CompareRuns, AMethodWithOtherSettingsIsComparedWithItsEarlierSelf) {
    std::mt19937_64 random(11);
    Analysis before = simulated_run(5, random), after = simulated_run(5, random, 2);
    rename(before, "a", "photon_mapper k=50", "map");
    rename(after, "a", "photon_mapper k=90", "map");
    rename(before, "b", "path", "path");
    rename(after, "b", "path roulette_edges=9", "path roulette_edges=9");
    rename(before, "c", "vcm", "vcm");
    rename(after, "c", "radiosity", "radiosity");
    const RunComparison comparison = compare_runs(before, after);
    EXPECT_THAT(
        comparison.remarks,
        ElementsAre("path: its settings differ: `path` in the old run, `path roulette_edges=9` in the new run",
                    "photon_mapper: its settings differ: `photon_mapper k=50` in the old run, `photon_mapper k=90` in "
                    "the new run",
                    "box, vcm: only in the old run", "box, radiosity: only in the new run"));
    EXPECT_GT(count_of(comparison, ChangeVerdict::worse, "photon_mapper k=50"), 0u);
    EXPECT_EQ(change_table(comparison).rows.front().back(), comparison.changes.front().method_after);
    EXPECT_THAT(change_text(comparison), HasSubstr("box, map\n"));

    // Two settings on each side: nobody knows which has become which.
    rename(before, "vcm", "path k=1", "path k=1");
    rename(after, "radiosity", "path k=2", "path k=2");
    EXPECT_THAT(compare_runs(before, after).remarks, Contains("box, path k=1: only in the old run"));
}

TEST(CompareRuns, ABusyMachineIsInconclusive) {
    std::mt19937_64 random(12);
    const Analysis before = simulated_run(5, random);
    Analysis after = simulated_run(5, random, 2);
    ASSERT_GT(count_of(compare_runs(before, after), ChangeVerdict::worse, "a"), 0u);
    for (Cell& cell : after.cells)
        if (cell.method == "a" && cell.seed == 2) {
            cell.processor_seconds = 10;
            cell.waiting_seconds = 2;
        }
    for (const auto& comparison : {compare_runs(before, after), compare_runs(after, before)}) {
        EXPECT_GT(count_of(comparison, ChangeVerdict::busy_machine, "a"), 0u);
        EXPECT_EQ(count_of(comparison, ChangeVerdict::busy_machine),
                  count_of(comparison, ChangeVerdict::busy_machine, "a"));
        EXPECT_EQ(count_of(comparison, ChangeVerdict::worse) + count_of(comparison, ChangeVerdict::better), 0u);
        EXPECT_THAT(change_text(comparison), HasSubstr("inconclusive: the machine was busy"));
    }
}

TEST(CompareRuns, OnABusyMachineErrorsAreComparedAtEqualPasses) {
    std::mt19937_64 random(13);
    const Analysis before = simulated_run(5, random);
    Analysis after = simulated_run(5, random, 2, 4);
    for (Cell& cell : after.cells)
        if (cell.method == "a") {
            cell.processor_seconds = 10;
            cell.waiting_seconds = 2;
        }
    const RunComparison comparison = compare_runs(before, after);
    std::vector<Change> at_passes = comparison.changes;
    std::erase_if(at_passes, [](const Change& change) { return change.of != Change::Of::error_at_passes; });
    ASSERT_EQ(at_passes.size(), 1u) << "seconds of the others compare";
    EXPECT_EQ(at_passes[0].method, "a");
    EXPECT_EQ(at_passes[0].at, 64);
    EXPECT_NEAR(at_passes[0].factor.value, 2, 0.2) << "the root of 4, although a pass takes twice as long";
    EXPECT_EQ(at_passes[0].verdict, ChangeVerdict::worse);
    EXPECT_EQ(count_of(comparison, ChangeVerdict::worse), 1u);
    EXPECT_THAT(change_text(comparison), HasSubstr("  error, 64 passes "));
    EXPECT_THAT(change_table(comparison).text(), HasSubstr(",error_at_passes,64,"));
}

}  // namespace
}  // namespace gib::test::run_comparison_test
