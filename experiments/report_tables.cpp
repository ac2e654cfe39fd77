#include "experiments/report_tables.h"

#include "experiments/html.h"
#include "experiments/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace gib {

namespace {

constexpr std::size_t stage_colors = 14;  // --stage-N of page.css

std::string root_percent(double rel_mse) { return percent_text(std::sqrt(std::max(0.0, rel_mse))); }
std::string clipped(double value) { return short_number(std::max(0.0, value)); }

std::size_t method_index(const Analysis& analysis, const std::string& method) {
    const auto& methods = analysis.index.methods;
    return static_cast<std::size_t>(std::find(methods.begin(), methods.end(), method) - methods.begin());
}

std::string method_cell(const Analysis& analysis, const TableRow& row) {
    return "<th scope=\"row\">" + method_html(method_index(analysis, row.method), row.method) + "</th>";
}

/// A table that scrolls on its own; `rows`: of a scene, those with `row_html` empty are left out.
std::string table_of(const Analysis& analysis, const std::string& scene, const std::string& caption,
                     const std::string& head, const std::function<std::string(const TableRow&)>& row_html) {
    std::string html = fmt::format(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n<table><thead><tr><th "
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

/// The least time to a target among the methods of a scene; infinite if none reaches it.
double least_time(const Analysis& analysis, const std::string& scene, const std::string& component, std::size_t t) {
    double least = std::numeric_limits<double>::infinity();
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.component == component && row.times[t])
            least = std::min(least, row.times[t]->value);
    return least;
}

std::string time_cell(const Analysis& analysis, const TableRow& row, std::size_t t) {
    if (!row.times[t]) return "<td class=\"never\" title=\"not reached\">&ndash;</td>";
    const bool best = row.times[t]->value <= least_time(analysis, row.scene, row.component, t);
    return fmt::format("<td{}>{}</td>", best ? " class=\"best\" title=\"cheapest\"" : "",
                       with_interval_html(*row.times[t], short_number));
}

std::string price_row(const Analysis& analysis, const TableRow& row) {
    const bool total = row.component == total_name;
    const auto& s = row.statistics;
    std::string html =
        s ? fmt::format("<td>{}</td>", with_interval_html(s->rel_mse, root_percent)) : "<td>not judged</td>";
    for (std::size_t t = 0; t < target_errors.size(); ++t)
        html += s ? time_cell(analysis, row, t) : "<td></td>";
    html += fmt::format("<td>{}</td><td>{}</td>", short_number(row.seconds),
                        row.prepare_seconds < 1e-3 ? "&lt; 0.001" : short_number(row.prepare_seconds));
    html += fmt::format("<td>{:.0f}</td>", row.peak_rss_mib);
    html += fmt::format("<td>{}</td><td>{}</td>", total && row.flip ? short_number(*row.flip) : "",
                        row.noise ? short_number(row.noise->centroid) : "");
    html += fmt::format("<td>{}</td>", row.nonfinite);
    return html + fmt::format("<td class=\"text\">{}</td>", html_escape(row.effects_missing));
}

/// bias^2 and variance as a share of their sum; nothing if one is not known.
std::string split_bar(const ReplicateStatistics& s) {
    const double bias = std::max(0.0, s.bias2->value), variance = std::max(0.0, s.variance->value);
    if (!(bias + variance > 0) || !std::isfinite(bias + variance)) return "";
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
    if (!s->bias2 || !s->variance) return html + "<td></td><td></td><td class=\"text\">one seed has no split</td>";
    html += fmt::format("<td>{}</td>", with_interval_html(*s->bias2, clipped));
    html += fmt::format("<td>{}</td>", with_interval_html(*s->variance, short_number));
    return html + fmt::format("<td class=\"text\">{}</td>", split_bar(*s));
}

/// Mean seconds by stage, in the order in which stages were met.
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

/// Of the whole page, so that a stage has one colour everywhere.
std::vector<std::string> stage_names(const Analysis& analysis) {
    std::vector<std::string> names;
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            if (std::find(names.begin(), names.end(), stage.name) == names.end()) names.push_back(stage.name);
    return names;
}

}  // namespace

std::string price_list_html(const Analysis& analysis, const std::string& scene) {
    std::string head = column("component") + column("error %", "relative RMSE of the final image");
    for (const char* target : target_names)
        head += column(fmt::format("to {} %", target), fmt::format("seconds until the relative RMSE is {} %", target));
    head += column("whole run s", "seconds of preparation and all passes") +
            column("preparation s", "seconds before the first pass; part of every time") +
            column("memory MiB", "the largest resident set of the cell's own process") +
            column("FLIP", "how much of the difference a viewer sees, 0 to 1") +
            column("noise centroid", "cycles per pixel; white noise has 0.383") +
            column("not finite", "samples that were dropped") + column("missing effects");
    return table_of(analysis, scene, "Price list of " + scene, head,
                    [&](const TableRow& row) { return price_row(analysis, row); });
}

std::string split_html(const Analysis& analysis, const std::string& scene) {
    const std::string head =
        column("component") + column("mean squared error") + column("bias&sup2;") + column("variance") +
        "<th scope=\"col\" class=\"text\"><span class=\"swatch bias\"></span>bias&sup2; against <span "
        "class=\"swatch noise\"></span>variance</th>";
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
