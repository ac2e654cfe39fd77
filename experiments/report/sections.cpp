#include "experiments/report/sections.h"

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/warnings.h"
#include "experiments/report/section_columns.h"
#include "experiments/report/words.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <ranges>

namespace gib {

namespace {

using Column = Section::Column;
using Row = Section::Row;

Column words(const char* heading) { return {heading, true}; }
Entry number(double value) { return {measured(value)}; }
Entry method_entry(const std::string& method, const std::string& text) { return {text, Mark::none, method}; }

/// The label of a method and, in brackets, that it is another renderer's.
std::string marked(const Analysis& analysis, const std::string& method) {
    return analysis.index.is_external(method) ? method + " (external)" : method;
}

/// The label of a row and, in brackets, that it is another renderer's, or the passes at which the labels that differ in
/// `spp` alone stopped.
std::string method_text(const Analysis& analysis, const TableRow& row) {
    if (row.is_external) return marked(analysis, row.method);
    if (row.seeds > 0 && row.seeds < analysis.index.seeds)
        return fmt::format("{} ({} of {} seeds)", row.method, row.seeds, analysis.index.seeds);
    const auto stops = analysis.stops.find({row.scene, row.method});
    if (stops == analysis.stops.end()) return row.method;
    return fmt::format("{} (stopped at spp = {} too)", row.method, fmt::join(stops->second, ", "));
}

Section warning_section(const Analysis& analysis) {
    Section section{"Warnings", "", {}, {}, Section::Kind::warnings};
    for (const Warning& w : analysis.warnings)
        section.rows.push_back({.scene = w.scene, .sentence = sentence_of(w), .is_warning = true});
    return section;
}

Section look_section(const Analysis& analysis) {
    Section section{"Each method at equal time",
                    "Relative RMSE, mean over the seeds, after the time of the fastest method; FLIP of seed 1's last "
                    "image that was kept by then. Bias or noise: of the final images.",
                    {words("method"),
                     {"seconds"},
                     {"relative RMSE %"},
                     words("beside the best"),
                     {"FLIP of the image"},
                     words("image"),
                     words("bias or noise"),
                     words("missing effects"),
                     words("energy differs in")},
                    {},
                    Section::Kind::looks};
    for (const auto& scene : scenes_of(analysis)) {
        const SceneLook look = scene_look(analysis, scene);
        for (const LookWords& w : look.methods)
            section.rows.push_back({.scene = scene,
                                    .entries = {{marked(analysis, w.look.method)},
                                                number(look.seconds),
                                                {w.error},
                                                {w.beside},
                                                {w.flip},
                                                {w.shown},
                                                {w.kind},
                                                {w.missing},
                                                {w.energy}}});
    }
    return section;
}

/// How the time of a row to an error stands beside those of the other methods.
Mark mark_of(const Analysis& analysis, const TableRow& row, std::size_t target) {
    if (!time_field(row, target).is_measured()) return Mark::grey;
    for (const Contender& c : Contest(analysis, row.scene, row.layer).to_error(target))
        if (c.method == row.method && c.standing == Standing::best) return Mark::best;
        else if (c.method == row.method && c.standing == Standing::tie) return Mark::tie;
    return Mark::none;
}

bool is_empty(const Entry& entry) {
    if (const auto* text = std::get_if<std::string>(&entry.shown)) return text->empty();
    return std::get<Field>(entry.shown).state == State::none;
}

/// The section with those columns of section_columns() that belong to it; rows without any text are left out.
Section row_section(const Analysis& analysis, RowSection which, std::string title, std::string sentence) {
    Section section{std::move(title), std::move(sentence), {words("method")}};
    if (which == in_noise) section.kind = Section::Kind::noise;
    for (const SectionColumn& column : section_columns())
        if (column.sections & which) section.columns.push_back({column.heading, column.value.index() == 1});
    for (const TableRow& row : analysis.rows) {
        std::vector<Entry> entries = {method_entry(row.method, method_text(analysis, row))};
        for (const SectionColumn& column : section_columns()) {
            if (!(column.sections & which)) continue;
            Entry& entry = entries.emplace_back(Entry{shown(column.value, row)});
            if (column.target) entry.mark = mark_of(analysis, row, *column.target);
            if (const auto* f = std::get_if<Field>(&entry.shown);
                f && which == in_noise && f->unit == Unit::share && f->is_measured())
                entry.shares = {f->value, 1 - f->value};
        }
        if (!std::all_of(entries.begin() + 1, entries.end(), is_empty))
            section.rows.push_back({.scene = row.scene, .entries = std::move(entries), .layer = row.layer});
    }
    return section;
}

/// Whether a row's component is black in the method's images and in the reference.
bool is_black(const Footing& footing) { return footing.energy.value == 0 && footing.excess.value == 0; }

Section footing_section(const Analysis& analysis) {
    Section section{
        "Equal footing", "Mean energy against the reference's, with 99 % intervals.", {}, {}, Section::Kind::words};
    if (analysis.index.seeds < 2) section.sentence += " One seed has no interval: run with two seeds or more.";
    const auto warnings = footing_warnings(analysis);
    for (const auto& scene : scenes_of(analysis)) {
        std::map<FootingVerdict, int> counts;
        for (const TableRow& row : analysis.rows)
            if (row.scene == scene && row.footing && !is_black(*row.footing)) ++counts[row.footing->verdict];
        const int agree = counts[FootingVerdict::agrees], differ = counts[FootingVerdict::differs];
        const int unresolved = counts[FootingVerdict::unresolved], all = agree + differ + unresolved;
        if (all == 0) continue;
        section.rows.push_back(
            {.scene = scene,
             .sentence = fmt::format("of {} components and totals that are not black, {} within {:.0f} %, {} beyond, "
                                     "{} not to be told (their intervals: `energy_excess` of `table.csv`).",
                                     all, agree, 100 * footing_tolerance, differ, unresolved)});
        for (const Warning& w : warnings)
            if (w.scene == scene)
                section.rows.push_back({.scene = scene, .sentence = sentence_of(w), .is_warning = true});
    }
    return section;
}

Section verdict_section(const Analysis& analysis) {
    Section section{
        "Which method is cheapest, and why",
        "The answer stands with the method. Seconds: to the relative RMSE beside it. The error is that after the best "
        "one's time; where no method has "
        "reached it, that of the final images. Of its squared error: shares of the sum of its components' squared "
        "errors. Bias or noise: of the "
        "final images.",
        {words("method"),
         {"to reach"},
         {"seconds"},
         {"times the best"},
         {"relative RMSE % then"},
         words("of its squared error"),
         words("bias or noise")},
        {},
        Section::Kind::verdict};
    for (const auto& scene : scenes_of(analysis))
        for (const VerdictRow& v : verdict(analysis, scene))
            section.rows.push_back(
                {.scene = scene,
                 .entries = {{v.method.empty() ? "none" : v.method, Mark::none, v.method, v.remark},
                             {v.target ? std::string(target_names[*v.target]) + " %" : std::string("any")},
                             {v.seconds, v.is_best                 ? Mark::best
                                         : v.seconds.is_measured() ? Mark::none
                                                                   : Mark::grey},
                             {v.factor},
                             {v.error},
                             {v.parts},
                             {v.kind}}});
    return section;
}

Section crossover_section(const Analysis& analysis) {
    Section section{
        "When the best method changes",
        "From these seconds on the method is closer to the reference than all others, by the mean over the seeds after "
        "equal time, by 5 % at least before the next change; 95 % intervals over the seeds. A tie: never told apart "
        "until the next change. Not run "
        "longer: ended before it.",
        {words("method"), {"from second"}, {"relative RMSE % there"}, words("before"), words("beside others")}};
    for (const Crossover& c : crossovers(analysis)) {
        if (c.ends)
            section.rows.push_back({.scene = c.scene,
                                    .entries = {{std::string("not known")},
                                                number(c.seconds),
                                                {Field{}},
                                                {c.before},
                                                {fmt::format("`{}` was not run longer", c.before)}}});
        else
            section.rows.push_back({.scene = c.scene,
                                    .entries = {method_entry(c.method, c.method),
                                                {measured({c.seconds, c.interval})},
                                                {c.relative_rmse},
                                                {c.before.empty() ? std::string("no image yet") : c.before},
                                                {words_of(c.doubts)}}});
    }
    return section;
}

/// The other methods' errors as multiples of the best one's. `unit`: s or passes.
std::string others_text(const EqualTimeRow& row, const std::string& unit) {
    std::string text;
    for (const Contender& c : row.ranking | std::views::drop(1)) {
        const std::string number =
            c.standing == Standing::no_image
                ? fmt::format("no image yet; first after {} {}", short_number(c.first_image), unit)
                : short_number(std::sqrt(c.mean / row.ranking.front().mean)) + (c.standing == Standing::tie ? " (tie)"
                                                                                : c.standing == Standing::incomplete
                                                                                    ? " (not all light)"
                                                                                    : "");
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", c.method, number);
    }
    return text;
}

/// The methods after equal seconds, or after equal passes in their place.
Section equal_section(const Analysis& analysis, std::string title, std::string sentence, bool is_time) {
    Section section{std::move(title),
                    std::move(sentence),
                    {words("component"),
                     {is_time ? "seconds" : "passes"},
                     words("best"),
                     {"relative RMSE %"},
                     words("beside others"),
                     words("times as much")}};
    for (const EqualTimeRow& row : equal_time_rows(analysis)) {
        const Contender* best = best_of(row.ranking);
        if (!best || !(best->mean > row.noise_floor)) continue;
        section.rows.push_back({.scene = row.scene,
                                .entries = {{std::string(name_of(row.layer))},
                                            {measured(row.seconds, is_time ? Unit::number : Unit::whole)},
                                            method_entry(best->method, best->method),
                                            {measured(best->mean, Unit::root)},
                                            {doubts(row.ranking)},
                                            {others_text(row, is_time ? "s" : "passes")}}});
    }
    return section;
}

Section equal_time_section(const Analysis& analysis) {
    return equal_section(
        analysis, "At equal time",
        "After the whole time of the fastest method; the reference's own error is subtracted where it is known.", true);
}

Section equal_passes_section(const Analysis& analysis) {
    const auto is_called_for = [&](const std::string& scene) { return calls_for_equal_passes(analysis, scene); };
    if (std::ranges::none_of(scenes_of(analysis), is_called_for)) return {};
    Section section = equal_section(
        with_passes_for_seconds(analysis), "At equal passes",
        "For scenes whose methods were not given equal times, or whose times a busy machine made too long: after all "
        "passes of the "
        "method that made the fewest. A pass is one sample a pixel; what it costs differs between methods.",
        false);
    std::erase_if(section.rows, [&](const Row& row) { return !is_called_for(row.scene); });
    return section;
}

Section frontier_section(const Analysis& analysis) {
    Section section{"Pareto frontier",
                    "The checkpoints that no other beats in both time and error, means over the seeds after equal "
                    "passes; the reference's own error is subtracted where it is known.",
                    {{"seconds"}, {"relative RMSE %"}, {"passes"}, words("method"), words("beside others")}};
    for (const FrontierPoint& p : pareto_frontier(analysis))
        section.rows.push_back({.scene = p.scene,
                                .entries = {number(p.seconds),
                                            {p.relative_rmse},
                                            {passes_text(p.least_passes, p.most_passes)},
                                            method_entry(p.method, p.method),
                                            {words_of(p.doubts)}}});
    return section;
}

Section bias_law_section(const Analysis& analysis) {
    Section section{
        "How bias falls",
        "bias^2 = c x^-p over the values x of one parameter, 95 % interval. Only values whose bias^2 is above 0 with "
        "its "
        "whole interval are fitted, and three are needed. Theory: where light is smooth.",
        {words("component"), words("method"), words("parameter"), {"values fitted"}, {"p"}, {"p by theory"}},
        {},
        Section::Kind::bias_laws};
    for (const BiasLaw& law : bias_laws(analysis))
        if (law.resolved_count > 0 || law.layer == Layer::total)
            section.rows.push_back({.scene = law.scene,
                                    .entries = {{std::string(name_of(law.layer))},
                                                {law.name},
                                                {law.parameter},
                                                {fmt::format("{} of {}", law.resolved_count, law.rows.size())},
                                                {law.fit ? measured(law.fit->exponent) : Field{State::not_resolved}},
                                                {law.theory ? measured(*law.theory) : Field{}}}});
    return section;
}

/// The settings that short names leave out.
Section settings_section(const Analysis& analysis) {
    Section section{"Settings",
                    "All settings that the experiment file gives.",
                    {words("label"), words("method with its settings")}};
    for (const TableRow& row : analysis.rows)
        if (row.layer == Layer::total && analysis.label_of(row.method) != row.method)
            section.rows.push_back(
                {.scene = row.scene,
                 .entries = {method_entry(row.method, row.method), {analysis.label_of(row.method)}}});
    return section;
}

/// A column for each stage of any cell.
Section stages_section(const Analysis& analysis) {
    Section section{"Where the time goes",
                    "Seconds of each stage, means over the seeds.",
                    {words("method")},
                    {},
                    Section::Kind::stages};
    std::map<std::string, std::size_t> columns;
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            if (columns.try_emplace(stage.name, section.columns.size()).second) section.columns.push_back({stage.name});
    std::map<std::string, double> longest;  // by scene
    for (const TableRow& row : analysis.rows) {
        if (row.layer != Layer::total) continue;
        std::vector<double> mean(section.columns.size());
        double sum = 0;
        for (const Cell& cell : analysis.cells)
            for (const auto& stage : cell.stages)
                if (cell.scene == row.scene && cell.method == row.method) {
                    mean[columns.at(stage.name)] += stage.seconds / std::max(row.seeds, 1);
                    sum += stage.seconds / std::max(row.seeds, 1);
                }
        longest[row.scene] = std::max(longest[row.scene], sum);
        Row& stages = section.rows.emplace_back(Row{.scene = row.scene});
        stages.entries = {method_entry(row.method, row.method)};
        stages.entries.front().shares.assign(mean.begin() + 1, mean.end());
        for (std::size_t i = 1; i < mean.size(); ++i)
            stages.entries.push_back({mean[i] > 0 ? measured(mean[i]) : Field{}});
    }
    for (Row& row : section.rows)
        for (double& share : row.entries.front().shares)
            share /= std::max(longest[row.scene], 1e-30);
    return section;
}

}  // namespace

std::vector<Section> sections(const Analysis& analysis) {
    std::vector<Section> all = {
        warning_section(analysis),
        look_section(analysis),
        verdict_section(analysis),
        footing_section(analysis),
        row_section(
            analysis, in_prices, "Price list",
            "Seconds until the relative RMSE, the reference's own error subtracted where it is known, is at the "
            "percentage above; "
            "95 % intervals over the seeds. Measured times are means over the seeds, each of which has reached it."),
        crossover_section(analysis),
        row_section(analysis, in_laws, "What more accuracy costs",
                    "The law of the squared error against time t is floor^2 + c (t - preparation)^-slope; what it says "
                    "beyond the measured span is marked as extrapolated. Halving: the factor by which time grows."),
        row_section(
            analysis, in_errors, "Errors",
            "Errors of the final images, with 95 % intervals over the seeds. `below`: the interval reaches 0, and "
            "this is its upper end."),
        row_section(analysis, in_outliers, "Errors of few pixels",
                    "The worst 0.1 % of the pixels hold most of the squared error of these images. The table has the "
                    "error without them and the median over the pixels, by the plain formulas."),
        row_section(
            analysis, in_noise, "Bias and noise",
            "The parts of the mean squared error of the final images, the reference's own variance subtracted where it "
            "is known, in "
            "absolute units, so that they do not add "
            "up to the square of the relative RMSE, of which the share is; and the noise's spatial frequencies."),
        equal_time_section(analysis),
        equal_passes_section(analysis),
        frontier_section(analysis),
        bias_law_section(analysis),
        stages_section(analysis),
        settings_section(analysis),
    };
    std::erase_if(all, [](const Section& section) { return section.rows.empty(); });
    return all;
}

std::string line_of(const Shown& shown) {
    const auto* field = std::get_if<Field>(&shown);
    return field ? line_of(*field) : std::get<std::string>(shown);
}

}  // namespace gib
