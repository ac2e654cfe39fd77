#include "experiments/hard_cases/hard_case_table.h"

#include "common/core/error.h"
#include "experiments/report/report_assets.h"
#include "experiments/text/html.h"
#include "experiments/text/markdown.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace gib {

namespace {

constexpr std::array<const char*, 19> columns = {
    "case",  "method", "expected", "got",   "verdict",  "lo",      "hi",         "relation", "reason", "why",
    "scene", "set",    "passes",   "seeds", "smallest", "largest", "not_finite", "negative", "seconds"};

std::string set_text(const std::map<std::string, std::string>& parameters) {
    std::string text;
    for (const auto& [name, value] : parameters)
        text += (text.empty() ? "" : " ") + fmt::format("--set {}={}", name, value);
    return text;
}

/// All lines of one case.
struct CaseLines {
    std::string name;
    std::vector<const HardCaseLine*> lines;

    const HardCaseLine* of(const std::string& method) const {
        for (const auto* line : lines)
            if (line->method == method) return line;
        return nullptr;
    }
};

std::vector<CaseLines> by_case(const HardCaseTable& table) {
    std::vector<CaseLines> cases;
    for (const auto& line : table.lines) {
        if (cases.empty() || cases.back().name != line.name) cases.push_back({line.name, {}});
        cases.back().lines.push_back(&line);
    }
    return cases;
}

std::vector<std::string> methods_of(const HardCaseTable& table) {
    std::vector<std::string> methods;
    for (const auto& line : table.lines)
        if (!line.method.empty() && std::find(methods.begin(), methods.end(), line.method) == methods.end())
            methods.push_back(line.method);
    return methods;
}

double number(const std::string& text) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// Mean and half width as text, "0.9983 ± 0.0021"; empty if there is no image.
std::string got_text(const HardCaseLine& line) {
    if (line.got.empty()) return "";
    const double half = (number(line.hi) - number(line.lo)) / 2;
    return half > 0 ? fmt::format("{:.4g} ± {:.2g}", number(line.got), half) : fmt::format("{:.4g}", number(line.got));
}

std::string expected_text(const HardCaseLine& line) {
    if (line.relation == "refused") return "refused";
    if (line.relation == "black") return "black";
    const std::string value = fmt::format("{:.6g}", number(line.expected));
    return line.relation == "at_most" ? "at most " + value : value;
}

std::string counts_text(const HardCaseTable& table) {
    std::string text;
    for (const Verdict verdict :
         {Verdict::holds, Verdict::fails, Verdict::unresolved, Verdict::left_out, Verdict::not_judged})
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name_of(verdict), table.count(verdict));
    return text;
}

bool is_bad(const HardCaseLine& line) {
    return line.verdict == name_of(Verdict::fails) || line.verdict == name_of(Verdict::unresolved);
}

std::string method_or_dash(const HardCaseLine& line) { return line.method.empty() ? "-" : line.method; }

std::string command_of(const HardCaseLine& line) {
    return fmt::format("gibench render {} {}{}--method \"{}\" -o OUT.exr", line.scene, line.set,
                       line.set.empty() ? "" : " ", line.method);
}

std::string cell_html(const HardCaseLine* line) {
    if (!line) return "<td></td>";
    std::string kind = line->verdict;
    std::replace(kind.begin(), kind.end(), ' ', '-');
    const std::string got = got_text(*line);
    return fmt::format("<td class=\"verdict-{}\" title=\"{}\">{}{}</td>", kind, html_escape(line->why),
                       html_escape(line->verdict),
                       got.empty() ? "" : "<span class=\"interval\">" + html_escape(got) + "</span>");
}

std::string bad_html(const HardCaseTable& table) {
    std::string html;
    for (const auto& line : table.lines)
        if (is_bad(line))
            html +=
                fmt::format("<li><b>{}</b>, {}: {} ({}). {}: {}<br><code>{}</code></li>\n", html_escape(line.name),
                            html_escape(method_or_dash(line)), html_escape(line.verdict), html_escape(line.why),
                            html_escape(expected_text(line)), html_escape(line.reason), html_escape(command_of(line)));
    if (html.empty()) return "<p>Every case holds.</p>\n";
    return "<div class=\"note\" role=\"note\"><b>These do not hold.</b><ul>\n" + html + "</ul></div>\n";
}

}  // namespace

std::size_t HardCaseTable::count(Verdict verdict) const {
    return static_cast<std::size_t>(std::count_if(
        lines.begin(), lines.end(), [&](const HardCaseLine& line) { return line.verdict == name_of(verdict); }));
}

CsvTable hard_case_csv(const std::vector<HardCaseRow>& rows) {
    CsvTable csv{{columns.begin(), columns.end()}, {}};
    for (const HardCaseRow& row : rows) {
        const auto& [verdict, got, half_width, why] = row.verdict;
        const auto only_if = [](bool there, double value) { return there ? csv_number(value) : std::string(); };
        const bool number = row.hard.relation != Relation::refused, image = got.has_value();
        csv.add({row.hard.name, row.method, only_if(number, row.hard.expected), only_if(image, got.value_or(0)),
                 std::string(name_of(verdict)), only_if(image, got.value_or(0) - half_width),
                 only_if(image, got.value_or(0) + half_width), std::string(name_of(row.hard.relation)), row.hard.reason,
                 why, row.hard.scene, set_text(row.hard.parameters), std::to_string(row.hard.passes),
                 std::to_string(row.hard.seeds), only_if(image, row.images.smallest),
                 only_if(image, row.images.largest), std::to_string(row.images.not_finite),
                 std::to_string(row.images.negative), fmt::format("{:.3f}", row.images.seconds)});
    }
    return csv;
}

HardCaseTable hard_case_table(const std::string& text, const std::string& file, const std::string& title) {
    const CsvTable csv = parse_csv(text, file);
    if (!std::equal(columns.begin(), columns.end(), csv.columns.begin(), csv.columns.end()))
        throw InputError({file}, "not a table of hard cases");
    HardCaseTable table{title, {}};
    for (const auto& r : csv.rows)
        table.lines.push_back({.name = r[0],
                               .method = r[1],
                               .expected = r[2],
                               .got = r[3],
                               .verdict = r[4],
                               .lo = r[5],
                               .hi = r[6],
                               .relation = r[7],
                               .reason = r[8],
                               .why = r[9],
                               .scene = r[10],
                               .set = r[11]});
    return table;
}

std::string hard_case_markdown(const HardCaseTable& table) {
    std::string text = fmt::format("# {}\n\n{}.\n", markdown_text(table.title), counts_text(table));
    for (const auto& line : table.lines)
        if (is_bad(line))
            text += fmt::format("\n- **{}**, {}: {} ({})", markdown_text(line.name),
                                markdown_text(method_or_dash(line)), line.verdict, markdown_text(line.why));
    const auto methods = methods_of(table);
    text += "\n\n| case | expected |";
    std::string rule = "\n|---|---|";
    for (const auto& method : methods) {
        text += fmt::format(" {} |", markdown_text(method));
        rule += "---|";
    }
    text += " reason |" + rule + "---|\n";
    for (const auto& [name, lines] : by_case(table)) {
        text += fmt::format("| {} | {} |", markdown_text(name), expected_text(*lines.front()));
        const CaseLines of_case{name, lines};
        for (const auto& method : methods) {
            const auto* line = of_case.of(method.empty() ? "" : method);
            if (!line) line = of_case.of("");
            text += line ? fmt::format(" {} {} |", line->verdict, got_text(*line)) : " |";
        }
        text += fmt::format(" {} |\n", markdown_text(lines.front()->reason));
    }
    return text;
}

std::string hard_case_html(const HardCaseTable& table) {
    const auto methods = methods_of(table);
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-"
        "Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n<meta name=\"viewport\" content=\"width="
        "device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<title>{0}</title>\n"
        "<style>\n{1}</style>\n</head>\n<body>\n<header>\n<h1>{0}</h1>\n<p class=\"muted\">{2}.</p>\n</header>\n"
        "<main>\n{3}<p class=\"muted\">A number is the mean radiance over pixels, channels and seeds, ± the half width "
        "of the interval on which its verdict rests. The tooltip of a verdict gives the reason.</p>\n<div "
        "class=\"scroll\"><table>\n<thead><tr><th>case</th><th>expected</th>",
        html_escape(table.title), report_style(), counts_text(table), bad_html(table));
    for (const auto& method : methods)
        html += fmt::format("<th>{}</th>", html_escape(method));
    html += "</tr></thead>\n<tbody>\n";
    for (const auto& of_case : by_case(table)) {
        const HardCaseLine& first = *of_case.lines.front();
        html += fmt::format("<tr><th>{}<span class=\"interval\">{}</span></th><td>{}</td>", html_escape(of_case.name),
                            html_escape(first.reason), html_escape(expected_text(first)));
        for (const auto& method : methods)
            html += cell_html(first.method.empty() ? &first : of_case.of(method));
        html += "</tr>\n";
    }
    return html + "</tbody>\n</table></div>\n</main>\n</body>\n</html>\n";
}

}  // namespace gib
