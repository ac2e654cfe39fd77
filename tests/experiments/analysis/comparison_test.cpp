// Rows and cells beside each other: errors at equal time, the Pareto frontier, the law of the bias in a sweep, labels that
// differ in spp alone, unlike processors, and bias that is 0 by theory; which components hold light, and what is judged of an
// image whose reference does not resolve all of them.
#include "experiments/analysis/comparison.h"

#include "experiments/analysis/analysis.h"
#include "experiments/analysis/method_names.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/warnings.h"
#include "experiments/report/report.h"
#include "experiments/report/sections.h"
#include "experiments/report/tables.h"
#include "experiments/results/judgement.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/constant_image.h"
#include "tests/support/csv_reader.h"
#include "tests/support/matchers.h"

#include <cmath>

namespace gib::test::comparison_test {
namespace {

TEST(EqualTime, ComparesErrorsAfterTheWholeTimeOfTheFastest) {
    const Analysis analysis = analysis_of(
        {run_of("path", 4e-4, 0.7, 90), run_of("slow_start", 1e-4, 64, 128), run_of("photons", 1e-4, 1, 16)});
    const auto rows = equal_time_rows(analysis);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].seconds, 16);
    EXPECT_EQ(rows[0].ranking[0].method, "photons");
    EXPECT_NEAR(rows[0].ranking[0].mean, 1e-4 / 16, 1e-12);
    // The error lies between the checkpoints at 11.2 and 22.4 s.
    EXPECT_NEAR(rows[0].ranking[1].mean, 4e-4 / 16, 1e-12);
    EXPECT_EQ(rows[0].ranking[2].standing, Standing::no_image) << "none after 16 s";
    EXPECT_THAT(markdown_table(analysis),
                HasSubstr("| box | total | 16.0 | photons | 0.25 | inconclusive: one seed | path: 2.00; slow_start: "
                          "no image yet; first after 64.0 s |"));
}

// Its runs end after 8 and 12 s. After 10 s, their mean, the second one is not complete.
TEST(EqualTime, TheFastestHasTheErrorOfItsFinalImages) {
    const auto rows = equal_time_rows(
        analysis_of({run_of("fast", 4e-4, 1, 8), run_of("fast", 4e-4, 1.5, 12), run_of("slow", 1e-2, 1, 64)}));
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].seconds, 10);
    EXPECT_EQ(rows[0].ranking.at(0).method, "fast");
    EXPECT_NEAR(rows[0].ranking.at(0).mean, (4e-4 / 8 + 4e-4 / 12) / 2, 1e-12);
}

// More time would not change the image of a method that has converged.
TEST(EqualTime, DoesNotEndWithAMethodThatHasConverged) {
    Analysis analysis =
        analysis_of({run_of("path", 4e-4, 0.7, 90), run_of("solution", 1e-2, 1, 4), run_of("photons", 1e-4, 1, 16)});
    analysis.rows.clear();
    analysis.cells[1].converged = true;
    const auto seconds = [&] { return Contest(analysis, "box").equal_time(); };
    EXPECT_EQ(seconds(), 16);
    for (Cell& cell : analysis.cells)
        cell.converged = true;
    EXPECT_NEAR(seconds(), 89.6, 1e-9) << "the longest, if each has";
}

// At 1, 2, 4 and 8 s the quick method has 4e-4 / t; the slow one starts at 4 s with 1e-4 / t.
TEST(ParetoFrontier, IsOfTheCheckpointsThatNoOtherBeats) {
    Analysis analysis;
    analysis.cells = {run_of("quick", 4e-4, 1, 8), run_of("slow", 1e-4, 4, 16)};
    const auto frontier = pareto_frontier(analysis);
    using Point = std::pair<std::string, double>;
    std::vector<Point> found;
    for (const auto& point : frontier) {
        found.emplace_back(point.method, point.seconds);
        EXPECT_NEAR(point.relative_rmse.value, (point.method == "quick" ? 4e-4 : 1e-4) / point.seconds, 1e-12);
    }
    EXPECT_THAT(found, ElementsAre(Point("quick", 1), Point("quick", 2), Point("slow", 4), Point("slow", 8),
                                   Point("slow", 16)));
    EXPECT_EQ(frontier[3].most_passes, 2u);
    EXPECT_THAT(markdown_table(analysis), HasSubstr("| box | 8.00 | 0.35 | 2 | slow | inconclusive: one seed |"));
    analysis.cells.resize(1);
    EXPECT_TRUE(pareto_frontier(analysis).empty());
}

TEST(BiasLaws, FindTheExponentAmongLabelsThatDifferInOneParameter) {
    Analysis analysis;
    analysis.cells = {run_of("photons k=50 photons=1e4", 1, 1, 2)};
    const auto add = [&](const std::string& method, const Estimate& bias2) {
        analysis.rows.push_back(row_of(method, Layer::total, bias2, 5));
    };
    const auto bias = [](double photons) {
        const double value = 3 * std::pow(photons, -1.5);
        return Estimate{value, Interval{value / 1.2, value * 1.2}};
    };
    for (const auto& [text, x] : {std::pair{"1e4", 1e4}, {"1e5", 1e5}, {"1e6", 1e6}})
        add(std::string("photons k=50 photons=") + text, bias(x));
    // The first row is below what the reference resolves, the second belongs to another sweep.
    add("photons k=50 photons=1e7", Estimate{1e-10, Interval{-1e-9, 1e-9}});
    add("photons k=auto photons=1e5", bias(1e7));
    const auto laws = bias_laws(analysis);
    ASSERT_EQ(laws.size(), 1u);
    EXPECT_EQ(laws[0].method, "photons k=50");
    EXPECT_EQ(laws[0].parameter, "photons");
    EXPECT_EQ(laws[0].resolved_count, 3u);
    EXPECT_EQ(laws[0].rows.size(), 4u);
    EXPECT_NEAR(laws[0].fit->exponent.value, 1.5, 1e-9);
    // Three points are log 10 apart, each with the deviation log 1.2 / 1.96:
    // standard error deviation / (log 10 sqrt 2).
    const double half = std::log(1.2) / (std::log(10.0) * std::sqrt(2.0));
    EXPECT_NEAR(laws[0].fit->exponent.interval->hi, 1.5 + half, 1e-9);
    EXPECT_NEAR(laws[0].fit->exponent.interval->lo, 1.5 - half, 1e-9);
    EXPECT_NEAR(laws[0].fit->factor, 3, 1e-6);
}

TEST(BiasLaws, SayNothingOfTwoPoints) {
    Analysis analysis;
    for (const std::string method : {"photons photons=1e4", "photons photons=1e5"}) {
        analysis.cells.push_back(run_of(method, 1, 1, 2));
        analysis.rows.push_back(row_of(method, Layer::total, Estimate{1, Interval{0.5, 2}}, 5));
    }
    EXPECT_TRUE(bias_laws(analysis).empty());
    EXPECT_THAT(markdown_table(analysis), Not(HasSubstr("How bias falls")));
}

/// Three labels of one method and a label of another. By its times the shortest run has the quickest passes.
Analysis sweep() {
    Analysis analysis;
    analysis.index.methods = {"path spp=4", "path spp=64", "path spp=16", "photon_mapper k=5 spp=64"};
    analysis.cells = {run_of("path spp=4", 1, 0.9, 4 * 0.9), run_of("path spp=64", 1, 1, 64),
                      run_of("path spp=16", 1, 0.95, 16 * 0.95), run_of("photon_mapper k=5 spp=64", 1, 2, 128)};
    for (const Cell& cell : analysis.cells) {
        analysis.rows.push_back(row_of(cell.method));
        analysis.rows.back().seconds = cell.last().seconds;
    }
    return analysis;
}

TEST(SameMethod, TheLongestRunStandsForAll) {
    const Analysis merged = one_label_a_method(sweep());
    std::vector<std::string> methods;
    for (const TableRow& row : merged.rows)
        methods.push_back(row.method);
    EXPECT_THAT(methods, ElementsAre("path spp=64", "photon_mapper k=5 spp=64"));
    EXPECT_EQ(merged.cells.size(), 2u);
    EXPECT_THAT(merged.stops.at({"box", "path spp=64"}), ElementsAre(4u, 16u));
    EXPECT_EQ(merged.stops.count({"box", "photon_mapper k=5 spp=64"}), 0u);
    EXPECT_EQ(merged.index.methods.size(), 4u) << "colours and places of the labels stay";
}

// A run that was interrupted must not hide one that has all seeds.
TEST(SameMethod, MoreCompleteSeedsComeBeforeMorePasses) {
    Analysis analysis = sweep();
    analysis.cells.push_back(run_of("path spp=16", 1, 0.95, 16 * 0.95, 0, 2));
    EXPECT_THAT(one_label_a_method(analysis).stops.at({"box", "path spp=16"}), ElementsAre(4u, 64u));
}

Cell measured_on(const std::string& cpu, const std::string& scene, const std::string& method) {
    Cell cell = cell_of(method);
    cell.scene = scene;
    cell.cpu = cpu;
    return cell;
}

TEST(Processors, UnlikeOnesOfAScene) {
    const std::vector<Cell> cells = {measured_on("A", "box", "path"),   measured_on("A", "box", "path"),
                                     measured_on("B", "box", "vcm"),    measured_on("B", "box", "path"),
                                     measured_on("A", "glass", "path"), measured_on("", "glass", "vcm")};
    EXPECT_THAT(unlike_processors(cells, "box")->sentence, HasSubstr("; on 'A': path; on 'B': path, vcm"));
    EXPECT_FALSE(unlike_processors(cells, "glass")) << "a record of an older version has no name";
}

TEST(KnownBias, NeedsEveryPathOfTheComponent) {
    EXPECT_FALSE(is_unbiased_by_theory(row_of("path spp=16"), {Component::caustic}));
    EXPECT_FALSE(is_unbiased_by_theory(row_of("path spp=16", Layer::caustic), {Component::caustic, Component::volume}));
    EXPECT_TRUE(is_unbiased_by_theory(row_of("path spp=16", Layer::direct), {Component::caustic, Component::volume}));
    EXPECT_FALSE(is_unbiased_by_theory(row_of("path max_depth=3 spp=16"), {})) << "shorter paths than the reference";
    TableRow row = row_of("path spp=16");
    row.nonfinite = 1;
    EXPECT_FALSE(is_unbiased_by_theory(row, {})) << "a dropped sample";
    row = row_of("path spp=16");
    row.effects_missing = {Effect::caustics};
    EXPECT_FALSE(is_unbiased_by_theory(row, {}));
}

// The columns of bias^2 keep the measured values; the column bias_state says that the method is unbiased.
TEST(KnownBias, IsAStateBesideTheMeasuredValue) {
    Analysis analysis;
    analysis.rows = {row_of("path spp=16", Layer::total, Estimate{0.5, Interval{0.25, 0.75}})};
    TableRow& row = analysis.rows[0];
    row.statistics->rel_bias2 = row.statistics->bias2;
    const auto field = [&](const std::string& name) { return field_of(error_table(analysis), name); };
    EXPECT_EQ(field("bias_state"), "measured");
    row.is_unbiased = true;
    EXPECT_EQ(field("bias_state"), "unbiased");
    EXPECT_EQ(field("bias2"), "0.5");
    EXPECT_EQ(bias_share_field(row).state, State::unbiased);
    row.statistics->bias2.reset();
    EXPECT_EQ(field("bias_state"), "") << "one seed";
}

Image constant(float value) { return constant_image(value, 2, 2); }

/// A reference with `direct` light and a black `emission`. Its method does not sample `caustic` and `volume`, which are
/// black.
Reference reference_of(float direct) {
    Reference reference;
    reference.total = {.mean = constant(direct), .standard_error = std::nullopt, .groups = {}};
    for (const auto& [c, value] : {std::pair(Component::direct, direct), std::pair(Component::emission, 0.f),
                                   std::pair(Component::caustic, 0.f), std::pair(Component::volume, 0.f)})
        reference.components[static_cast<std::size_t>(index_of(c))] =
            ReferenceLayer{.mean = constant(value), .standard_error = std::nullopt, .groups = {}};
    reference.unresolved = {Component::caustic, Component::volume};
    return reference;
}

ComponentImages image_of(float caustic, float volume) {
    ComponentImages image{.width = 2, .height = 2, .parts = {}};
    image[Component::caustic] = constant(caustic);
    image[Component::volume] = constant(volume);
    return image;
}

TEST(SceneLight, IsUnknownUntilSomeImageHasAllPathsOfAComponent) {
    SceneLight light(reference_of(1));
    using C = Components;
    const Component caustic = Component::caustic, volume = Component::volume, direct = Component::direct;
    EXPECT_EQ(light.holding_light({Component::emission, direct, caustic, volume}), C({direct, caustic, volume}))
        << "the reference resolves that emission is black, and cannot tell of the unresolved ones";
    light.add({image_of(0, 0)}, {caustic});
    EXPECT_EQ(light.holding_light({caustic, volume}), C({caustic}))
        << "this method has all paths of `volume`: it is black";
    light.add({image_of(0, 0)}, {});
    EXPECT_TRUE(light.holding_light({caustic, volume}).empty());
}

TEST(SceneLight, IsSeenInAnyImage) {
    SceneLight light(reference_of(1));
    light.add({image_of(0, 0)}, {});
    const Components both = {Component::caustic, Component::volume};
    light.add({image_of(0, 0), image_of(0, 0.5f)}, both);
    EXPECT_EQ(light.holding_light(both), Components({Component::volume}));
}

// An image whose judged part is black on both sides would have no error at all.
TEST(Judgement, HasNoTotalWhereNothingIsJudged) {
    const ComponentImages image = image_of(1, 1);
    const Reference whole = reference_of(1), nothing = reference_of(0);
    const Judgement judged(whole), empty(nothing);
    EXPECT_FALSE(judged.is_empty());
    EXPECT_EQ(judged.errors(image, 0.01).count(Layer::total), 1u);
    EXPECT_TRUE(empty.is_empty());
    EXPECT_EQ(empty.errors(image, 0.01).count(Layer::total), 0u);
    Reference black = reference_of(0);
    black.unresolved.clear();
    EXPECT_FALSE(Judgement(black).is_empty()) << "a scene without light is judged";
}

}  // namespace
}  // namespace gib::test::comparison_test
