#include "experiments/report/report_tables.h"

#include "experiments/analysis/price.h"
#include "experiments/report/price_text.h"
#include "experiments/report/tables.h"
#include "experiments/text/html.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace gib {

namespace {

constexpr std::size_t stage_colors = 14;  // --stage-N of page.css

std::string root_percent(double rel_mse) { return percent_text(std::sqrt(at_least_zero(rel_mse))); }
std::string clipped(double value) { return short_number(at_least_zero(value)); }

std::size_t method_index(const Analysis& analysis, const std::string& method) {
    const auto& methods = analysis.index.methods;
    return static_cast<std::size_t>(std::find(methods.begin(), methods.end(), method) - methods.begin());
}

std::string method_cell(const Analysis& analysis, const TableRow& row) {
    return "<th scope=\"row\">" + method_html(method_index(analysis, row.method), row.method) + "</th>";
}

/// A table of a scene's rows that scrolls on its own. Rows whose `row_html` is empty are left out.
std::string table_of(const Analysis& analysis, const std::string& scene, const std::string& caption,
                     const std::string& head, const std::function<std::string(const TableRow&)>& row_html) {
    std::string html = fmt::format(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n<table "
        "class=\"by-component\"><thead><tr><th "
        "scope=\"col\">method</th>{}</tr></thead>\n<tbody>\n",
        html_escape(caption), head);
    for (const TableRow& row : analysis.rows) {
        if (row.scene != scene) continue;
        const std::string cells = row_html(row);
        if (cells.empty()) continue;
        html += fmt::format("<tr data-component=\"{}\"{}>{}<td class=\"component\">{}</td>{}</tr>\n",
                            html_escape(row.component), row.component == total_name ? "" : " class=\"part\"",
                            method_cell(analysis, row), html_escape(row.component), cells);
    }
    return html + "</tbody></table></div>\n";
}

std::string column(const std::string& name, const std::string& explanation = "") {
    return fmt::format("<th scope=\"col\"{}>{}</th>",
                       explanation.empty() ? "" : fmt::format(" title=\"{}\"", html_escape(explanation)), name);
}

/// The row of the method that reaches target `t` first; null if none does.
const TableRow* cheapest(const Analysis& analysis, const std::string& scene, const std::string& component,
                         std::size_t t) {
    const TableRow* best = nullptr;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.component == component && row.times[t] &&
            (!best || row.times[t]->value < best->times[t]->value))
            best = &row;
    return best;
}

/// HTML of a text such as "42.0 (extrapolated)", with the part in brackets below the rest.
std::string in_two_lines(const std::string& text) {
    const std::size_t at = text.find(" (");
    if (at == std::string::npos || text.back() != ')') return html_escape(text);
    return fmt::format("{}<span class=\"interval\">{}</span>", html_escape(text.substr(0, at)),
                       html_escape(text.substr(at + 2, text.size() - at - 3)));
}

/// HTML of names such as "a;b_c", written "a, b c".
std::string spaced_names(const std::string& names) {
    std::string text;
    for (const char c : names)
        text += c == ';' ? ", " : c == '_' ? " " : std::string(1, c);
    return html_escape(text);
}

std::string time_cell(const Analysis& analysis, const TableRow& row, std::size_t t) {
    if (!is_target_resolved(analysis, row.scene, row.component, t))
        return "<td class=\"never\" title=\"the noise of the reference is larger\">not resolved</td>";
    if (!row.times[t]) {
        const std::string guess = unmeasured_time(row, target_errors[t]);
        return guess.empty() ? "<td class=\"never\" title=\"not reached\">&ndash;</td>"
                             : fmt::format("<td class=\"never\">{}</td>", in_two_lines(guess));
    }
    const bool best = &row == cheapest(analysis, row.scene, row.component, t);
    return fmt::format("<td{}>{}</td>", best ? " class=\"best\" title=\"cheapest\"" : "",
                       with_interval_html(*row.times[t], short_number));
}

std::string price_row(const Analysis& analysis, const TableRow& row) {
    const auto& s = row.statistics;
    std::string html =
        s ? fmt::format("<td>{}</td>",
                        in_two_lines(relative_error_text(row, analysis.noise_floor(row.scene, row.component))))
          : "<td>not judged</td>";
    for (std::size_t t = 0; t < target_errors.size(); ++t)
        html += s ? time_cell(analysis, row, t) : "<td></td>";
    html += fmt::format("<td>{}</td><td>{}</td><td>{:.0f}</td>",
                        row.prepare_seconds < 1e-3 ? "&lt; 0.001" : short_number(row.prepare_seconds),
                        short_number(row.seconds), row.peak_rss_mib);
    return html + fmt::format("<td class=\"text\">{}</td>", spaced_names(row.effects_missing));
}

/// The floor as a relative error [%] and its parts. A floor whose interval reaches 0 is not resolved.
std::string floor_cells(const TableRow& row) {
    const auto& [floor, interval] = row.law->floor;
    if (interval && !(interval->lo > 0))
        return fmt::format("<td>below {}</td><td></td><td></td>", root_percent(interval->hi));
    if (!interval) return fmt::format("<td>{}</td><td></td><td></td>", root_percent(floor));
    const double bias2 = floor_bias2(row);
    return fmt::format("<td>{}</td><td>{}</td><td>{}</td>", with_interval_html(row.law->floor, root_percent),
                       root_percent(bias2), root_percent(floor - bias2));
}

std::string law_row(const TableRow& row) {
    if (!row.law) return "";
    std::string html =
        fmt::format("<td>{}</td>", row.last_halving ? with_interval_html(*row.last_halving, short_number) : "");
    html += fmt::format("<td>{}</td>", in_two_lines(next_halving_text(row))) + floor_cells(row);
    html += fmt::format("<td>{}</td>", with_interval_html(row.law->slope, short_number));
    return html + fmt::format("<td>{:.0f} %</td>", 100 * row.law->misfit);
}

/// A bar of the shares of bias^2 and variance in their sum; empty if one of them is not known.
std::string split_bar(const ReplicateStatistics& s) {
    if (!std::isfinite(s.bias2->value) || !std::isfinite(s.variance->value)) return "";
    const double bias = at_least_zero(s.bias2->value), variance = at_least_zero(s.variance->value);
    if (!(bias + variance > 0)) return "";
    const double share = 100 * bias / (bias + variance);
    return fmt::format(
        "<span class=\"split\" role=\"img\" aria-label=\"{0:.0f} % bias, {1:.0f} % noise\"><span class=\"bias\" "
        "style=\"width:{0:.1f}%\"></span><span class=\"noise\" style=\"width:{1:.1f}%\"></span></span><span "
        "class=\"share\">{0:.0f} % bias</span>",
        share, 100 - share);
}

std::string split_row(const TableRow& row) {
    const auto& s = row.statistics;
    if (!s) return "";
    std::string html = fmt::format("<td>{}</td>", with_interval_html(s->mse, short_number));
    if (s->bias2 && s->variance)
        html += fmt::format("<td>{}</td><td>{}</td><td class=\"text split-cell\">{}</td>",
                            with_interval_html(*s->bias2, clipped), with_interval_html(*s->variance, short_number),
                            split_bar(*s));
    else html += "<td></td><td></td><td class=\"text\">one seed has no split</td>";
    html += row.noise ? fmt::format("<td>{}</td><td>{}</td>", short_number(row.noise->centroid),
                                    short_number(row.noise->low_ratio))
                      : "<td></td><td></td>";
    return html + fmt::format("<td>{}</td><td>{}</td>", row.flip ? short_number(*row.flip) : "", row.nonfinite);
}

/// The mean seconds of each stage, in the order of first occurrence.
std::vector<StageTimes::Stage> mean_stages(const Analysis& analysis, const std::string& scene,
                                           const std::string& method) {
    std::vector<StageTimes::Stage> mean;
    int seeds = 0;
    for (const Cell& cell : analysis.cells) {
        if (cell.scene != scene || cell.method != method) continue;
        ++seeds;
        for (const auto& stage : cell.stages) {
            auto found = std::find_if(mean.begin(), mean.end(), [&](const auto& m) { return m.name == stage.name; });
            if (found == mean.end()) found = mean.insert(mean.end(), {stage.name, 0.0});
            found->seconds += stage.seconds;
        }
    }
    for (auto& stage : mean)
        stage.seconds /= std::max(seeds, 1);
    return mean;
}

/// The stages of all scenes, so that a stage has one colour on the whole page.
std::vector<std::string> stage_names(const Analysis& analysis) {
    std::vector<std::string> names;
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            if (std::find(names.begin(), names.end(), stage.name) == names.end()) names.push_back(stage.name);
    return names;
}

}  // namespace

std::string overview_html(const Analysis& analysis) {
    std::string html =
        "<div class=\"scroll overview\" role=\"region\" tabindex=\"0\" aria-label=\"The cheapest methods\">\n<table>"
        "<thead><tr><th scope=\"col\">scene</th>";
    for (const std::size_t t : asked_targets)
        html += fmt::format("<th scope=\"col\" class=\"text\">cheapest at {} %</th>", target_names[t]);
    html += "</tr></thead>\n<tbody>\n";
    for (std::size_t i = 0; i < analysis.references.size(); ++i) {
        const std::string& scene = analysis.references[i].scene;
        html += fmt::format("<tr><th scope=\"row\"><a href=\"#scene-{}\">{}</a></th>", i, html_escape(scene));
        for (const std::size_t t : asked_targets) {
            const TableRow* best = cheapest(analysis, scene, total_name, t);
            html +=
                best ? fmt::format("<td class=\"text\">{} <b>{} s</b></td>",
                                   method_html(method_index(analysis, best->method), best->method),
                                   short_number(best->times[t]->value))
                     : fmt::format("<td class=\"text never\">{}</td>",
                                   is_target_resolved(analysis, scene, total_name, t) ? "not reached" : "not resolved");
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string price_list_html(const Analysis& analysis, const std::string& scene) {
    std::string head = column("component") +
                       column("error of the final image %", "relative RMSE, the reference's own error subtracted");
    for (const char* target : target_names)
        head += column(fmt::format("to {} %", target), fmt::format("seconds until the relative RMSE is {} %", target));
    head += column("prepa&shy;ration s", "seconds before the first pass; part of every time") +
            column("whole run s", "seconds of preparation and all passes") +
            column("memory MiB", "the largest resident set of the cell's own process") +
            "<th scope=\"col\" class=\"text\">missing effects</th>";
    return table_of(analysis, scene, "Price list of " + scene, head,
                    [&](const TableRow& row) { return price_row(analysis, row); });
}

std::string laws_html(const Analysis& analysis, const std::string& scene) {
    const std::string head =
        column("component") + column("last halving", "factor of time for the last halving of the error, as measured") +
        column("next halving (extrapolated)", "factor of time for half the error of the final image, by the law") +
        column("floor %", "relative RMSE that more time does not remove, by the law") + column("of it bias %") +
        column("of it fixed noise %", "variance that more time does not remove, such as that of a fixed photon map") +
        column("slope", "how fast the squared error above its floor falls: as time^-slope; 1 for independent samples") +
        column("worst point off the law",
               "the largest distance of a point from the law, as a share of the squared error");
    return table_of(analysis, scene, "Laws of " + scene, head, law_row);
}

std::string crossovers_html(const Analysis& analysis, const std::vector<Crossover>& changes, const std::string& scene) {
    std::string rows;
    for (const Crossover& change : changes) {
        if (change.scene != scene) continue;
        rows += fmt::format(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
            method_html(method_index(analysis, change.method), change.method),
            with_interval_html({change.seconds, change.interval}, short_number),
            change.relative_rmse > 0 ? percent_text(change.relative_rmse) : "below the reference's",
            change.before.empty() ? "no image yet" : method_html(method_index(analysis, change.before), change.before));
    }
    if (rows.empty()) return "";
    return fmt::format(
        "<h3>When the best method changes</h3>\n<p class=\"muted\">From these seconds on a method is closer to the "
        "reference than all others, by 5 % at least before the next change.</p>\n<div class=\"scroll fitting\" "
        "role=\"region\" tabindex=\"0\" aria-label=\"When the best method of {} changes\">\n<table><thead><tr><th "
        "scope=\"col\">best method</th>{}{}<th scope=\"col\" class=\"text\">before</th></tr></thead>\n<tbody>\n{}"
        "</tbody></table></div>\n",
        html_escape(scene), column("from second"), column("relative RMSE % there"), rows);
}

std::string split_html(const Analysis& analysis, const std::string& scene) {
    const std::string head =
        column("component") + column("mean squared error") + column("bias&sup2;") + column("variance") +
        "<th scope=\"col\" class=\"text\"><span class=\"swatch bias\"></span>bias&sup2; against <span "
        "class=\"swatch noise\"></span>variance</th>" +
        column("noise centroid", "cycles per pixel; white noise has 0.383") +
        column("low frequencies", "noise power below 0.1 cycles per pixel as a multiple of white noise's") +
        column("FLIP", "how much of the difference a viewer sees, 0 to 1") +
        column("not finite", "samples that were dropped");
    return table_of(analysis, scene, "Bias and noise of " + scene, head, split_row);
}

std::string stages_html(const Analysis& analysis, const std::string& scene) {
    const auto names = stage_names(analysis);
    std::vector<bool> used(names.size(), false);
    double longest = 0;
    for (const auto& row : analysis.rows)
        if (row.scene == scene) longest = std::max(longest, row.seconds);
    std::string bars;
    for (const auto& row : analysis.rows) {
        if (row.scene != scene || row.component != total_name) continue;
        std::string parts, words;
        for (const auto& stage : mean_stages(analysis, scene, row.method)) {
            const auto i = static_cast<std::size_t>(std::find(names.begin(), names.end(), stage.name) - names.begin());
            used[i] = used[i] || stage.seconds > 0;
            const std::string text = fmt::format("{} {} s", html_escape(stage.name), short_number(stage.seconds));
            parts += fmt::format("<span style=\"width:{:.2f}%;background:var(--stage-{})\" title=\"{}\"></span>",
                                 100 * stage.seconds / std::max(longest, 1e-12), i % stage_colors, text);
            words += (words.empty() ? "" : ", ") + text;
        }
        bars += fmt::format(
            "<div class=\"name\">{}</div><div class=\"bar\" role=\"img\" aria-label=\"{}\">{}</div><div "
            "class=\"seconds\">{} s</div>\n",
            method_html(method_index(analysis, row.method), row.method), words, parts, short_number(row.seconds));
    }
    std::string legend;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (used[i])
            legend += fmt::format("<li><span class=\"swatch\" style=\"background:var(--stage-{})\"></span>{}</li>",
                                  i % stage_colors, html_escape(names[i]));
    return "<div class=\"stages\">\n" + bars + "</div>\n<ul class=\"legend\">" + legend + "</ul>\n";
}

}  // namespace gib
