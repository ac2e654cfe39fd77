#include "experiments/report/sections.h"

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/footing_warnings.h"
#include "experiments/analysis/price.h"
#include "experiments/report/look_words.h"
#include "experiments/report/price_text.h"
#include "experiments/report/row_columns.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace gib {

namespace {

std::string error_text(double relative_rmse) {
    return relative_rmse > 0 ? percent_text(relative_rmse) : "below the reference's";
}

/// The label of a method and, in brackets, that it is another renderer's.
std::string marked(const Analysis& analysis, const std::string& method) {
    return analysis.index.is_external(method) ? method + " (external)" : method;
}

/// The label of a row and, in brackets, that it is another renderer's, or the passes at which the labels that differ in
/// `spp` alone stopped.
std::string method_text(const Analysis& analysis, const TableRow& row) {
    if (row.is_external) return marked(analysis, row.method);
    const auto stops = analysis.stops.find({row.scene, row.method});
    if (stops == analysis.stops.end()) return row.method;
    return fmt::format("{} (stopped at spp = {} too)", row.method, fmt::join(stops->second, ", "));
}

Section look_section(const Analysis& analysis) {
    Section section{look_title,
                    "Relative RMSE, mean over the seeds, after the time of the fastest method; FLIP of seed 1's last "
                    "image that was kept by then. Bias or noise: of the final images.",
                    {"method", "seconds", "relative RMSE %", "FLIP of the image", "image", "bias or noise",
                     "missing effects", "energy differs in"},
                    {}};
    for (const auto& scene : scenes_of(analysis))
        for (const LookWords& words : look_words(analysis, scene))
            section.rows.push_back({scene,
                                    {marked(analysis, words.look.method), short_number(words.look.seconds), words.error,
                                     words.flip, words.shown, words.kind, words.missing, words.energy}});
    return section;
}

/// The section with those columns of row_columns() that belong to it; rows without any text are left out.
Section row_section(const Analysis& analysis, RowSection which, std::string title, std::string sentence) {
    Section section{std::move(title), std::move(sentence), {"method"}, {}};
    for (const RowColumn& column : row_columns())
        if (column.sections & which) section.columns.push_back(column.heading);
    for (const TableRow& row : analysis.rows) {
        std::vector<std::string> fields = {method_text(analysis, row)};
        for (const RowColumn& column : row_columns())
            if (column.sections & which) fields.push_back(column.section_text(row));
        if (std::any_of(fields.begin() + 1, fields.end(), [](const auto& field) { return !field.empty(); }))
            section.rows.push_back({row.scene, std::move(fields), row.component});
    }
    return section;
}

/// Whether a row's component is black in the method's images and in the reference.
bool is_black(const Footing& footing) { return footing.energy.value == 0 && footing.excess.value == 0; }

Section footing_section(const Analysis& analysis) {
    Section section{"Equal footing", "Mean energy against the reference's, with 99 % intervals.", {}, {}};
    const bool one_seed = analysis.index.seeds < 2;
    if (one_seed) section.sentence += " One seed has no interval: run with two seeds or more.";
    const auto warnings = footing_warnings(analysis);
    for (const auto& scene : scenes_of(analysis)) {
        std::map<FootingVerdict, int> counts;
        for (const TableRow& row : analysis.rows)
            if (row.scene == scene && row.footing && !is_black(*row.footing)) ++counts[row.footing->verdict];
        const int agree = counts[FootingVerdict::agrees], differ = counts[FootingVerdict::differs];
        const int unresolved = counts[FootingVerdict::unresolved], all = agree + differ + unresolved;
        if (all == 0) continue;
        section.rows.push_back({scene,
                                {fmt::format("of {} components and totals that are not black {} agree within {:.0f} %, "
                                             "{} differ, {} cannot be told.",
                                             all, agree, 100 * footing_tolerance, differ, unresolved)}});
        for (const auto& [of, method, differs, text] : warnings)
            if (of == scene && (differs || !one_seed))
                section.rows.push_back({scene, {fmt::format("{}{}.", differs ? "Warning: " : "", text)}});
    }
    return section;
}

Section answers_section(const Analysis& analysis) {
    Section section{"Which method is cheapest, and why", "", {}, {}};
    for (const PriceAnswer& answer : price_answers(analysis))
        section.rows.push_back({answer.scene, {answer.text}});
    return section;
}

Section crossover_section(const Analysis& analysis) {
    Section section{
        "When the best method changes",
        "From these seconds on the method is closer to the reference than all others, by 5 % at least before "
        "the next change; 95 % intervals over the seeds.",
        {"method", "from second", "relative RMSE % there", "before"},
        {}};
    for (const auto& [scene, method, before, seconds, interval, error] : crossovers(analysis))
        section.rows.push_back({scene,
                                {method, with_interval({seconds, interval}), error_text(error),
                                 before.empty() ? "no image yet" : before}});
    return section;
}

Section equal_time_section(const Analysis& analysis) {
    Section section{"At equal time",
                    "After the whole time of the fastest method; the reference's own error is subtracted.",
                    {"component", "seconds", "best", "relative RMSE %", "times as much"},
                    {}};
    for (const auto& [scene, component, seconds, entries] : equal_time_rows(analysis)) {
        const auto& [best, error] = entries.front();
        std::string others;
        for (std::size_t i = 1; i < entries.size(); ++i)
            others += fmt::format("{}{}: {}", i > 1 ? "; " : "", entries[i].method,
                                  short_number(entries[i].relative_rmse / error));
        section.rows.push_back({scene, {component, short_number(seconds), best, percent_text(error), others}});
    }
    return section;
}

Section frontier_section(const Analysis& analysis) {
    Section section{"Pareto frontier",
                    "The checkpoints that no other beats in both time and error; the reference's own error is "
                    "subtracted.",
                    {"seconds", "relative RMSE %", "passes", "method"},
                    {}};
    for (const auto& [scene, method, passes, seconds, error] : pareto_frontier(analysis))
        section.rows.push_back({scene, {short_number(seconds), error_text(error), std::to_string(passes), method}});
    return section;
}

Section bias_law_section(const Analysis& analysis) {
    Section section{
        "How bias falls",
        "bias^2 = c x^-p over the values x of one parameter, 95 % interval; values whose bias is below what "
        "the reference resolves are left out.",
        {"component", "method", "parameter", "values fitted", "p"},
        {}};
    for (const auto& [scene, component, method, parameter, values, exponent, count] : bias_laws(analysis))
        section.rows.push_back(
            {scene,
             {component, method, parameter, fmt::format("{} of {}", count, values.size()), with_interval(exponent)}});
    return section;
}

/// A column for each stage of any cell.
Section stages_section(const Analysis& analysis) {
    Section section{"Where the time goes", "Seconds of each stage, means over the seeds.", {"method"}, {}};
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            if (std::find(section.columns.begin(), section.columns.end(), stage.name) == section.columns.end())
                section.columns.push_back(stage.name);
    for (const TableRow& row : analysis.rows) {
        if (row.component != total_name) continue;
        std::map<std::string, double> mean;
        for (const Cell& cell : analysis.cells)
            if (cell.scene == row.scene && cell.method == row.method)
                for (const auto& stage : cell.stages)
                    mean[stage.name] += stage.seconds / std::max(row.seeds, 1);
        std::vector<std::string> fields = {row.method};
        for (std::size_t i = 1; i < section.columns.size(); ++i)
            fields.push_back(mean[section.columns[i]] > 0 ? short_number(mean[section.columns[i]]) : "");
        section.rows.push_back({row.scene, std::move(fields)});
    }
    return section;
}

}  // namespace

std::vector<Section> sections(const Analysis& analysis) {
    std::vector<Section> all = {
        look_section(analysis),
        answers_section(analysis),
        footing_section(analysis),
        row_section(
            analysis, in_prices, "Price list",
            "Seconds until the relative RMSE, the reference's own error subtracted, is at the percentage above; "
            "95 % intervals over the seeds."),
        crossover_section(analysis),
        row_section(analysis, in_laws, "What more accuracy costs",
                    "The law of the squared error against time t is floor^2 + c (t - preparation)^-slope; what it says "
                    "beyond the measured span is marked as extrapolated. Halving: the factor by which time grows."),
        row_section(analysis, in_errors, "Errors",
                    "Errors of the final images, with 95 % intervals over the seeds. An estimate of bias^2 below 0 is "
                    "shown as 0."),
        row_section(analysis, in_outliers, "Errors of few pixels",
                    "The worst 0.1 % of the pixels hold most of the squared error of these images. The table has the "
                    "error without them and the median over the pixels, by the plain formulas."),
        row_section(
            analysis, in_noise, "Bias and noise",
            "The parts of the mean squared error of the final images, in absolute units, so that they do not add "
            "up to the square of the relative RMSE; and the noise's spatial frequencies."),
        equal_time_section(analysis),
        frontier_section(analysis),
        bias_law_section(analysis),
        stages_section(analysis),
    };
    std::erase_if(all, [](const Section& section) { return section.rows.empty(); });
    return all;
}

}  // namespace gib
