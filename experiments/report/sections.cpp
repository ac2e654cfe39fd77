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
                    "Relative RMSE after the time of the shortest run, mean over the seeds. The image, with its FLIP: "
                    "seed 1's last one within 1.1 times that time. Bias or noise: of the final images.",
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

/// The rank of a row's time to an error among all methods.
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
bool is_black(const EnergyBalance& balance) { return balance.energy.value == 0 && balance.excess.value == 0; }

Section balance_section(const Analysis& analysis) {
    Section section{"Energy balance",
                    "Mean energy relative to the reference's, with 99 % intervals.",
                    {},
                    {},
                    Section::Kind::words};
    if (analysis.index.seeds < 2) section.sentence += " Intervals need two seeds or more.";
    const auto warnings = balance_warnings(analysis);
    for (const auto& scene : scenes_of(analysis)) {
        std::map<BalanceVerdict, int> counts;
        for (const TableRow& row : analysis.rows)
            if (row.scene == scene && row.balance && !is_black(*row.balance)) ++counts[row.balance->verdict];
        const int agree = counts[BalanceVerdict::agrees], differ = counts[BalanceVerdict::differs];
        const int inconclusive = counts[BalanceVerdict::inconclusive], all = agree + differ + inconclusive;
        if (all == 0) continue;
        section.rows.push_back({.scene = scene,
                                .sentence = fmt::format("of {} values (components and totals of all methods that are "
                                                        "not black), {} within {:.0f} %, {} beyond, "
                                                        "{} inconclusive (intervals: `energy_excess` of `table.csv`).",
                                                        all, agree, 100 * balance_tolerance, differ, inconclusive)});
        for (const Warning& w : warnings)
            if (w.scene == scene)
                section.rows.push_back({.scene = scene, .sentence = sentence_of(w), .is_warning = true});
    }
    return section;
}

Section verdict_section(const Analysis& analysis) {
    Section section{
        "Which method is cheapest, and why",
        "Relative RMSE: after the best method's time, or of the final images if no method reached the error. Error by "
        "component: shares of the sum of the components' squared errors. Bias or noise: of the final images.",
        {words("method"),
         {"to reach"},
         {"seconds"},
         {"times the best"},
         {"relative RMSE %"},
         words("error by component"),
         words("bias or noise")},
        {},
        Section::Kind::verdict};
    for (const auto& scene : scenes_of(analysis))
        for (const VerdictRow& v : verdict(analysis, scene))
            section.rows.push_back(
                {.scene = scene,
                 .entries = {{!v.target          ? "no verdict"
                              : v.method.empty() ? "none"
                                                 : v.method,
                              Mark::none, v.method, v.remark},
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
        "From these seconds on the method has the smallest error after equal time, mean over the seeds. Its lead "
        "reaches 5 "
        "% or more before the next change. Not significantly different: at no time before that change. Not run longer: "
        "the run ended before that change.",
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
                : short_number(std::sqrt(c.mean / row.ranking.front().mean)) +
                      (c.standing == Standing::tie          ? " (not significant)"
                       : c.standing == Standing::incomplete ? " (not all light)"
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
    return equal_section(analysis, "At equal time", "After the time of the shortest run.", true);
}

Section equal_passes_section(const Analysis& analysis) {
    const auto is_called_for = [&](const std::string& scene) { return calls_for_equal_passes(analysis, scene); };
    if (std::ranges::none_of(scenes_of(analysis), is_called_for)) return {};
    Section section = equal_section(
        with_passes_for_seconds(analysis), "At equal passes",
        "For scenes whose methods had unequal times, or times from a busy machine. Errors after the smallest mean "
        "number of passes of any method. A pass is one sample a pixel; its cost differs between methods.",
        false);
    std::erase_if(section.rows, [&](const Row& row) { return !is_called_for(row.scene); });
    return section;
}

Section frontier_section(const Analysis& analysis) {
    Section section{"Pareto frontier",
                    "Checkpoints that no other beats in both time and error; means over the seeds after equal passes.",
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
        "Fit of bias^2 = c x^-p over the values x of one parameter. It needs three values whose interval of bias^2 "
        "lies "
        "above 0. The p by theory holds for smooth light.",
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
                                                {law.fit ? measured(law.fit->exponent) : Field{State::below_noise}},
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
        balance_section(analysis),
        row_section(
            analysis, in_prices, "Price list",
            "Seconds until the relative RMSE reaches the percentage above. A measured time is the mean over the seeds, "
            "if all have reached the error."),
        crossover_section(analysis),
        row_section(
            analysis, in_laws, "What more accuracy costs",
            "Law of the squared error at time t: (error floor)^2 + c (t - preparation)^-slope. Cost of halving the "
            "error: the factor by which time grows."),
        row_section(analysis, in_errors, "Errors", "Of the final images."),
        row_section(
            analysis, in_outliers, "Errors of few pixels",
            "The worst 0.1 % of the pixels hold most of the squared error of these images. These errors include the "
            "reference's own variance."),
        row_section(
            analysis, in_noise, "Bias and noise",
            "Mean squared error of the final images, and its parts bias^2 and variance. Each is estimated by itself, "
            "so "
            "they need not add up. The share of bias^2 is that in the square of the relative RMSE, which weighs pixels "
            "differently. Centroid and low frequencies: spectrum of the noise."),
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
