// One page of a made-up analysis with all sections and most sentences of table.md, and the verdict on the terminal.
// tests/experiments/report/golden.txt holds the text as it was read and found right. After a change that is meant, copy
// the page of this run, whose path the failure names, over it and read the difference.

#include "experiments/analysis/warnings.h"
#include "experiments/report/report.h"
#include "experiments/report/terminal.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/matchers.h"
#include "tests/support/source_path.h"

#include "common/core/files.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

namespace gib::test::golden_page_test {
namespace {

/// Four seeds of a method whose squared relative error is floor + c / t, with images after first, 2 first, ... `last`
/// [s].
void add_runs(std::vector<Cell>& cells, const std::string& scene, const std::string& method, double c, double first,
              double last, double floor = 0) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        Cell& cell = cells.emplace_back(
            run_of(method, c * (1 + 0.02 * (static_cast<double>(seed) - 2.5)), first, last, floor, seed));
        cell.scene = scene;
        cell.cpu = "a processor";
        cell.stages = {{"trace", 0.75 * cell.last().seconds}, {"other", 0.25 * cell.last().seconds}};
        for (auto& [checkpoint, errors] : cell.checkpoints) {
            errors.at(Layer::total).rel_mse_corrected *= checkpoint.passes % 3 == 1 ? 1.03 : 0.98;  // about the law
            for (const auto& [layer, share] : {std::pair{Layer::caustic, 0.9}, {Layer::indirect, 0.1}})
                errors[layer] = {0, 0, 0, share * errors.at(Layer::total).rel_mse_corrected};
        }
    }
}

std::vector<Cell> cells() {
    std::vector<Cell> cells;
    for (const auto& [spp, last] : {std::pair("16", 0.16), {"64", 0.64}})
        add_runs(cells, "box", std::string("path spp=") + spp, 1.6e-2, 0.01, last);
    for (const auto& [photons, floor] : {std::pair("1e3", 9e-3), {"1e4", 9e-4}, {"1e5", 9e-5}})
        add_runs(cells, "box", std::string("photon_mapper photons=") + photons, 1e-3, 0.02, 0.64, floor);
    add_runs(cells, "box", "radiosity", 1e-3, 0.01, 0.08, 4e-4);
    add_runs(cells, "box", "vcm", 1e-3, 0.9, 1.8);
    add_runs(cells, "box", "tracer scene=1", 2e-2, 0.02, 0.64);
    // The first run ends before the times at which the others reach the smaller errors; the last two do not differ
    // significantly.
    add_runs(cells, "hall", "path spp=16", 1e-2, 0.5, 8, 4.25e-3);
    add_runs(cells, "hall", "vcm", 1e-1, 0.5, 64);
    add_runs(cells, "hall", "radiosity", 1.0001e-1, 0.5, 64);
    add_runs(cells, "fog", "path spp=16", 1e-2, 1, 4);
    return cells;
}

TableRow& row(Analysis& analysis, const std::string& scene, const std::string& method) {
    return const_cast<TableRow&>(*analysis.row(scene, method, Layer::total));
}

/// Rows of nothing but errors, for each thing that can be said of bias and noise.
void add_kinds_of_error(Analysis& analysis) {
    using Ends = std::optional<Interval>;
    int number = 0;
    for (const auto& [bias2, ends, variance] : {std::tuple(0.6, Ends({0.5, 0.7}), 0.4),
                                                {0.2, Ends({0.1, 0.3}), 0.8},
                                                {0.4, Ends({0.1, 0.7}), 0.6},
                                                {0.05, Ends({-0.05, 0.16}), 0.95},
                                                {-0.1, Ends({-0.2, 0.1}), 1.},
                                                {-0.1, Ends({-0.2, -0.01}), 1.},
                                                {0.3, Ends({-0.1, 0.7}), 0.7},
                                                {0.5, Ends({-1, 2}), 0.5},
                                                {0.5, Ends(), 0.5}}) {
        TableRow& row = analysis.rows.emplace_back(
            row_of("kind n=" + std::to_string(++number), Layer::total, Estimate{bias2, ends}, 4));
        row.scene = "errors";
        row.seeds = 4;
        row.statistics->rel_mse = {0.0102, Interval{0.0083, 0.0123}};
        row.statistics->rel_mse_corrected = 0.01;
        row.statistics->variance = Estimate{variance, {}};
        const double scale = 0.01 / (bias2 + variance);
        row.statistics->rel_bias2 = Estimate{scale * bias2, {}};
        if (ends) row.statistics->rel_bias2->interval = Interval{scale * ends->lo, scale * ends->hi};
        analysis.index.methods.push_back(row.method);
    }
    analysis.rows.back().noise_floor = 0.02;
    analysis.rows.back().nonfinite = 3;
}

void add_facts(Analysis& analysis) {
    TableRow &path = row(analysis, "box", "path spp=64"), &coarse = row(analysis, "box", "photon_mapper photons=1e3"),
             &radiosity = row(analysis, "box", "radiosity"), &tracer = row(analysis, "box", "tracer scene=1");
    path.is_unbiased = true;
    path.noise = NoiseSpectrum{{{0.1, 1}}, 0.38, 0.9};
    path.flip = 0.125;
    path.least_passes = path.most_passes = 64;
    path.peak_rss_mib = 51.7;
    coarse.statistics->bias2 = coarse.statistics->rel_bias2 = Estimate{8.1e-3, Interval{7e-3, 9e-3}};
    coarse.statistics->variance = Estimate{1.5e-3, Interval{1e-3, 2e-3}};
    coarse.noise = NoiseSpectrum{{}, 0.2, -0.1};
    coarse.robust = RobustError{4e-4, 9e-4, 0.75};
    coarse.least_passes = 12;
    coarse.most_passes = 16;
    radiosity.effects_missing = {Effect::caustics, Effect::refraction};
    radiosity.components_missing = {Component::caustic};
    radiosity.balance = EnergyBalance{{1, {}}, 1, {-0.12, Interval{-0.15, -0.09}}, BalanceVerdict::differs};
    path.balance = EnergyBalance{{1, {}}, 1, {0, Interval{-0.001, 0.001}}, BalanceVerdict::agrees};
    coarse.balance = EnergyBalance{{1, {}}, 1, {0, Interval{-0.04, 0.04}}, BalanceVerdict::inconclusive};
    tracer.is_external = true;
    analysis.index.externals = {tracer.method};
    row(analysis, "hall", "path spp=16").unsampled = 4.25e-3;
    row(analysis, "hall", "path spp=16").is_unbiased = true;
    row(analysis, "hall", "vcm").contradicted_in = {Layer::total, Layer::caustic};
    for (const double photons : {1e3, 1e4, 1e5}) {
        TableRow& sweep = row(analysis, "box", fmt::format("photon_mapper photons=1e{:.0f}", std::log10(photons)));
        sweep.statistics->bias2 = Estimate{3 / photons, Interval{2.5 / photons, 3.6 / photons}};
    }
    for (EqualTimeLook& look : analysis.looks)
        look.flip = 0.0625;
}

Analysis made_up() {
    Analysis analysis = analysis_of(cells());
    analysis.index.title = "A made-up analysis";
    analysis.index.threads = 2;
    analysis.index.experiment_text = "scenes = ['box.xml']\n[budget]\npasses = 64\n[[method]]\nname = 'path'\n";
    analysis.index.given_names = {{"radiosity", "radiosity, coarse"}};
    analysis.references = {
        {.scene = "box", .method = "auto", .relative_error = 0.004, .target = 0.005, .samples = 4096},
        {.scene = "hall", .method = "path", .relative_error = 0.01, .notes = {"a remark"}},
        {.scene = "fog", .method = "image.exr", .error_known = false}};
    analysis.references[2].unjudged = {Component::volume};
    add_facts(analysis);
    add_kinds_of_error(analysis);
    for (Cell& cell : analysis.cells)
        if (cell.scene == "hall") {
            cell.processor_seconds = 2 * cell.last().seconds;
            cell.waiting_seconds = cell.processor_seconds / 2;
        }
    analysis.warnings.push_back(*busy_machine(analysis, "gibench run 'e.toml'"));
    analysis.missing_cells = 2;
    return analysis;
}

TEST(GoldenPage, IsTheOneThatWasRead) {
    const Analysis analysis = made_up();
    const std::string page = markdown_table(analysis) + "\n## On the terminal\n\n" + terminal_verdict(analysis);
    const std::string mine = testing::TempDir() + "golden.txt";
    write_file(mine, page);
    EXPECT_EQ(read_file(source_path("tests/experiments/report/golden.txt")), page) << "The page of this run: " << mine;
}

}  // namespace
}  // namespace gib::test::golden_page_test
