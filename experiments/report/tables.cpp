#include "experiments/report/tables.h"

#include "common/core/files.h"
#include "experiments/analysis/comparison.h"
#include "experiments/analysis/footing_warnings.h"
#include "experiments/report/price_text.h"
#include "experiments/text/markdown.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>

namespace gib {

namespace {

std::string optional_number(const std::optional<double>& value) { return value ? csv_number(*value) : ""; }

std::string value_of(const std::optional<Estimate>& e) { return e ? csv_number(e->value) : ""; }
std::string lower_of(const std::optional<Estimate>& e) { return e && e->interval ? csv_number(e->interval->lo) : ""; }
std::string upper_of(const std::optional<Estimate>& e) { return e && e->interval ? csv_number(e->interval->hi) : ""; }

void append_estimate(std::vector<std::string>& row, const std::optional<Estimate>& e) {
    row.push_back(value_of(e));
    row.push_back(lower_of(e));
    row.push_back(upper_of(e));
}

/// Appends the law of the price: error^2 = floor + factor (seconds - prepare_seconds)^-slope.
void append_law(std::vector<std::string>& row, const TableRow& r) {
    const auto& price = r.law;
    append_estimate(row, price ? std::optional(price->floor) : std::nullopt);
    row.push_back(price ? csv_number(floor_bias2(r)) : "");
    append_estimate(row, price ? std::optional(price->slope) : std::nullopt);
    row.push_back(price ? csv_number(price->law.factor) : "");
    row.push_back(price ? csv_number(price->misfit) : "");
    append_estimate(row, price ? price->next_halving : std::nullopt);
}

std::vector<std::string> error_columns() {
    std::vector<std::string> columns = {"scene",          "method",         "component", "seeds",    "seconds",
                                        "rmse",           "rmse_lo",        "rmse_hi",   "rel_mse",  "rel_mse_lo",
                                        "rel_mse_hi",     "bias2",          "bias2_lo",  "bias2_hi", "variance",
                                        "noise_centroid", "noise_low_ratio"};
    for (std::size_t t = 0; t < 4; ++t)
        columns.push_back(fmt::format("seconds_to_{}pct", target_names[t]));
    for (const char* name : {"nonfinite", "peak_rss_mib", "effects_missing", "variance_lo", "variance_hi",
                             "rmse_corrected", "rel_mse_corrected"})
        columns.emplace_back(name);
    columns.push_back(fmt::format("seconds_to_{}pct", target_names[4]));
    for (const char* target : target_names)
        for (const char* end : {"lo", "hi"})
            columns.push_back(fmt::format("seconds_to_{}pct_{}", target, end));
    for (const char* name : {"prepare_seconds",  "flip",
                             "rel_mse_resolved", "energy_excess",
                             "energy_excess_lo", "energy_excess_hi",
                             "footing",          "last_halving",
                             "last_halving_lo",  "last_halving_hi",
                             "law_floor",        "law_floor_lo",
                             "law_floor_hi",     "law_floor_bias2",
                             "law_slope",        "law_slope_lo",
                             "law_slope_hi",     "law_factor",
                             "law_misfit",       "next_halving",
                             "next_halving_lo",  "next_halving_hi",
                             "rel_mse_median",   "rel_mse_trimmed",
                             "rel_mse_top_share"})
        columns.emplace_back(name);
    return columns;
}

std::vector<std::string> error_row(const TableRow& r, double noise_floor) {
    std::vector<std::string> row = {r.scene, r.method, r.component, std::to_string(r.seeds), csv_number(r.seconds)};
    const auto& s = r.statistics;
    append_estimate(row, s ? std::optional(s->rmse) : std::nullopt);
    append_estimate(row, s ? std::optional(s->rel_mse) : std::nullopt);
    append_estimate(row, s ? s->bias2 : std::nullopt);
    row.push_back(value_of(s ? s->variance : std::nullopt));
    row.push_back(optional_number(r.noise ? std::optional(r.noise->centroid) : std::nullopt));
    row.push_back(optional_number(r.noise ? std::optional(r.noise->low_ratio) : std::nullopt));
    for (std::size_t t = 0; t < 4; ++t)
        row.push_back(value_of(r.times[t]));
    row.push_back(std::to_string(r.nonfinite));
    row.push_back(csv_number(r.peak_rss_mib));
    row.push_back(r.effects_missing);
    row.push_back(lower_of(s ? s->variance : std::nullopt));
    row.push_back(upper_of(s ? s->variance : std::nullopt));
    // The corrected errors are undefined where the error is below what the reference resolves.
    row.push_back(s && std::isfinite(s->rmse_corrected) ? csv_number(s->rmse_corrected) : "");
    row.push_back(s && std::isfinite(s->rel_mse_corrected) ? csv_number(s->rel_mse_corrected) : "");
    row.push_back(value_of(r.times[4]));
    for (const auto& time : r.times) {
        row.push_back(lower_of(time));
        row.push_back(upper_of(time));
    }
    row.push_back(csv_number(r.prepare_seconds));
    row.push_back(optional_number(r.flip));
    row.push_back(csv_number(noise_floor));
    append_estimate(row, r.footing ? std::optional(r.footing->excess) : std::nullopt);
    row.push_back(r.footing ? name_of(r.footing->verdict) : "");
    append_estimate(row, r.last_halving);
    append_law(row, r);
    for (const auto value : {&RobustError::median, &RobustError::trimmed, &RobustError::share})
        row.push_back(r.robust && std::isfinite((*r.robust).*value) ? csv_number((*r.robust).*value) : "");
    return row;
}

std::string with_interval(const Estimate& e, const std::function<std::string(double)>& text) {
    if (!e.interval) return text(e.value);
    return fmt::format("{} ({} to {})", text(e.value), text(e.interval->lo), text(e.interval->hi));
}

std::string markdown_row(const TableRow& r, double noise_floor) {
    if (!r.statistics) return "";
    const auto& s = *r.statistics;
    // Estimates of bias^2 may be negative; this table shows 0 for them, the CSV file keeps them.
    const std::string bias2 = s.bias2 ? short_number(at_least_zero(s.bias2->value)) : "";
    return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", markdown_text(r.scene),
                       markdown_text(r.method), short_number(r.seconds), relative_error_text(r, noise_floor),
                       r.flip ? short_number(*r.flip) : "", bias2, s.variance ? short_number(s.variance->value) : "",
                       r.times[1] ? with_interval(*r.times[1], short_number) : "",
                       r.noise ? short_number(r.noise->centroid) : "", r.effects_missing);
}

/// The section about images whose mean error is that of a few pixels; empty if there are none.
std::string outliers_text(const Analysis& analysis) {
    std::string text;
    for (const auto& row : analysis.rows)
        if (row.component == total_name && row.robust && is_decided_by_outliers(*row.robust))
            text += fmt::format("| {} | {} | {} | {} | {} |\n", markdown_text(row.scene), markdown_text(row.method),
                                percent_text(row.robust->share), percent_text(std::sqrt(row.robust->trimmed)),
                                percent_text(std::sqrt(row.robust->median)));
    if (text.empty()) return "";
    return "\n## Errors of few pixels\n\nThe worst 0.1 % of the pixels hold most of the squared error of these images. "
           "The table has the error without them and the median over the pixels, by the plain formulas.\n\n"
           "| scene | method | share of the worst % | relative RMSE without them % | median % |\n"
           "|---|---|---:|---:|---:|\n" +
           text;
}

}  // namespace

CsvTable curves_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = {"scene",           "method",    "seed",         "pass", "seconds",
                     "prepare_seconds", "spp",       "photons",      "mse",  "rmse",
                     "rel_mse",         "nonfinite", "peak_rss_mib", "rays", "rel_mse_corrected"};
    for (const Cell& cell : analysis.cells)
        for (const auto& [checkpoint, errors] : cell.checkpoints) {
            const auto total = errors.find(total_name);
            const double nan = std::numeric_limits<double>::quiet_NaN();
            const ImageError error =
                total != errors.end()
                    ? total->second
                    : ImageError{
                          .mse = nan, .rmse = nan, .rel_mse = nan, .mse_corrected = nan, .rel_mse_corrected = nan};
            table.add({cell.scene, cell.method, std::to_string(cell.seed), std::to_string(checkpoint.passes),
                       csv_number(checkpoint.seconds), csv_number(cell.prepare_seconds),
                       std::to_string(checkpoint.passes), std::to_string(checkpoint.counts.photons),
                       csv_number(error.mse), csv_number(error.rmse), csv_number(error.rel_mse),
                       std::to_string(checkpoint.counts.non_finite.count), csv_number(checkpoint.peak_rss_mib),
                       std::to_string(checkpoint.counts.rays), csv_number(error.rel_mse_corrected)});
        }
    return table;
}

CsvTable error_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = error_columns();
    for (const auto& row : analysis.rows)
        table.add(error_row(row, analysis.noise_floor(row.scene, row.component)));
    return table;
}

CsvTable spectra_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = {"scene", "method", "kind", "frequency", "power", "component"};
    for (const auto& row : analysis.rows) {
        const auto add = [&](const char* kind, const std::vector<SpectrumPoint>& curve) {
            for (const auto& point : curve)
                table.add(
                    {row.scene, row.method, kind, csv_number(point.frequency), csv_number(point.power), row.component});
        };
        if (row.noise) add("noise", row.noise->curve);
        add("bias", row.bias);
    }
    return table;
}

CsvTable stages_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = {"scene", "method", "seed", "stage", "seconds"};
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            table.add({cell.scene, cell.method, std::to_string(cell.seed), stage.name, csv_number(stage.seconds)});
    return table;
}

std::string markdown_table(const Analysis& analysis) {
    const ResultIndex& index = analysis.index;
    std::string text = fmt::format("# {}\n\nRelative errors with epsilon = {}; {} seed{}; {} thread{}.\n",
                                   markdown_text(index.title), index.epsilon, index.seeds, index.seeds == 1 ? "" : "s",
                                   index.threads, index.threads == 1 ? "" : "s");
    for (const auto& reference : analysis.references) {
        text += fmt::format("\nReference of {}: {}, {} samples a pixel, relative standard error {} %{}.\n",
                            markdown_text(reference.scene), reference.method, reference.samples,
                            percent_text(reference.relative_error),
                            reference.target ? fmt::format(" (target {} %)", percent_text(*reference.target)) : "");
        for (const auto& note : reference.notes)
            text += fmt::format("Note: {}.\n", markdown_text(note));
    }
    if (analysis.missing_cells > 0)
        text += fmt::format("\n{} cells of the experiment are not complete.\n", analysis.missing_cells);
    text += footing_text(analysis);
    text +=
        "\n## Errors\n\n| scene | method | seconds | relative RMSE % | FLIP | bias^2 | variance | seconds to 5 % | "
        "noise centroid | "
        "missing effects |\n"
        "|---|---|---:|---:|---:|---:|---:|---:|---:|---|\n";
    for (const auto& row : analysis.rows)
        if (row.component == total_name) text += markdown_row(row, analysis.noise_floor(row.scene, total_name));
    return text + outliers_text(analysis) + price_text(analysis) + comparison_text(analysis);
}

void write_tables(const Analysis& analysis, const ResultFolder& folder) {
    write_file(folder.file("curves.csv"), curves_table(analysis).text());
    write_file(folder.file("table.csv"), error_table(analysis).text());
    write_file(folder.file("table.md"), markdown_table(analysis));
    write_file(folder.file("spectra.csv"), spectra_table(analysis).text());
    write_file(folder.file("stages.csv"), stages_table(analysis).text());
}

std::string relative_error_text(const TableRow& row, double noise_floor) {
    const auto& s = *row.statistics;
    if (s.rel_mse_corrected <= noise_floor)
        return fmt::format("below {}, not resolved", percent_text(std::sqrt(noise_floor)));
    const auto root = [&](double rel_mse) {  // an end of the plain interval, less the reference's variance
        return std::sqrt(at_least_zero(rel_mse - (s.rel_mse.value - s.rel_mse_corrected)));
    };
    Estimate relative{std::sqrt(s.rel_mse_corrected), std::nullopt};
    if (s.rel_mse.interval) relative.interval = Interval{root(s.rel_mse.interval->lo), root(s.rel_mse.interval->hi)};
    return with_interval(relative, percent_text);
}

}  // namespace gib
