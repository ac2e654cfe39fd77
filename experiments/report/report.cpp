#include "experiments/report/report.h"

#include "common/core/files.h"
#include "experiments/analysis/same_method.h"
#include "experiments/report/look_words.h"
#include "experiments/report/photon_links.h"
#include "experiments/report/price_text.h"
#include "experiments/report/report_data.h"
#include "experiments/report/report_pictures.h"
#include "experiments/report/sections.h"
#include "experiments/report/tuning_section.h"
#include "experiments/results/color_maps.h"
#include "experiments/text/embedded_files.h"
#include "experiments/text/html.h"
#include "experiments/text/numbers.h"
#include "experiments/text/template_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <set>

namespace gib {

using nlohmann::json;

namespace {

using kainjow::mustache::data;
using kainjow::mustache::list;
using kainjow::mustache::object;

data optional_text(const std::string& text) { return text.empty() ? data(false) : data(text); }

/// Whether a column holds words, which stand on the left.
bool is_of_words(const std::string& column) {
    static const std::set<std::string> names = {
        "method",        "before",          "best",  "component",     "parameter",
        "times as much", "missing effects", "image", "bias or noise", "energy differs in"};
    return names.count(column) > 0;
}

/// A field. A text such as "12.3 (11.2 to 13.5)" has what stands in brackets as `detail`.
data field_data(const std::string& text, bool first, bool of_words) {
    const std::size_t at = text.find(" (");
    const bool split = at != std::string::npos && text.back() == ')';
    return object{{"value", text.substr(0, split ? at : std::string::npos)},
                  {"detail", split ? data(text.substr(at + 2, text.size() - at - 3)) : data(false)},
                  {"tag", first ? "th" : "td"},
                  {"first", first},
                  {"words", of_words}};
}

data row_data(const Section::Row& row, const Section& section) {
    list fields;
    for (std::size_t i = 0; i < section.columns.size(); ++i)
        fields.push_back(field_data(row.fields[i], i == 0, is_of_words(section.columns[i])));
    return object{{"scene", row.scene},
                  {"component", optional_text(row.component)},
                  {"sentence", row.fields.front()},
                  {"warning", row.fields.front().starts_with("Warning")},
                  {"fields", fields}};
}

using Keeps = std::function<bool(const Section::Row&)>;

/// The sections with some of their rows; those without rows are left out.
data sections_data(const std::vector<Section>& all, const Keeps& keeps) {
    list sections;
    for (const Section& section : all) {
        list columns, rows;
        for (const auto& row : section.rows)
            if (keeps(row)) rows.push_back(row_data(row, section));
        if (rows.empty()) continue;
        for (const auto& name : section.columns)
            columns.push_back(object{{"name", name}, {"words", is_of_words(name)}, {"first", columns.empty()}});
        sections.push_back(object{{"title", section.title},
                                  {"intro", optional_text(section.sentence)},
                                  {"by_component", !section.rows.front().component.empty()},
                                  {"columns", columns},
                                  {"table", !columns.empty()},
                                  {"rows", rows},
                                  {section.title, true}});  // the report puts charts beside some sections
    }
    return sections;
}

/// ", 2.80 s (extrapolated)" of "2.80 (extrapolated)", and the like; empty for words without a time.
std::string seconds_text(const std::string& time) {
    const std::size_t at = time.find(" (extrapolated)");
    return at == std::string::npos ? "" : ", " + time.substr(0, at) + " s" + time.substr(at);
}

/// The method that reaches each of asked_targets first; none where a part of the light is not judged.
data cheapest_data(const ReferenceQuality& quality, const Analysis& analysis) {
    list cheapest;
    for (const std::size_t t : asked_targets) {
        const TableRow* best = nullptr;
        if (!quality.unjudged.empty()) {
            cheapest.push_back(object{{"method", "not judged"}, {"seconds", false}});
            continue;
        }
        for (const TableRow& row : analysis.rows)
            if (row.scene == quality.scene && row.component == total_name && reaches(row, t) &&
                (!best || row.times[t]->value < best->times[t]->value))
                best = &row;
        const bool resolved = is_target_resolved(t, analysis.noise_floor(quality.scene, total_name));
        if (best) {
            cheapest.push_back(
                object{{"method", best->method}, {"seconds", short_number(best->times[t]->value) + " s"}});
            continue;
        }
        // Where no method has reached the error, the closest one and its time by the fitted law stand there.
        const TableRow* closest = resolved ? closest_row(analysis, quality.scene) : nullptr;
        const std::string time = closest ? time_text(*closest, t) : "";
        const std::string detail = fmt::format("closest: {}{}", closest ? closest->method : "", seconds_text(time));
        cheapest.push_back(object{{"method", resolved ? "not reached" : "not resolved"},
                                  {"seconds", closest ? data(detail) : data(false)}});
    }
    return cheapest;
}

/// The images of a scene at equal time, which the report's script draws beside these words.
data looks_data(const Analysis& analysis, const std::string& scene) {
    list looks;
    for (const LookWords& words : look_words(analysis, scene))
        looks.push_back(object{{"method", words.look.method},
                               {"attribute", html_escape(words.look.method)},
                               {"external", analysis.index.is_external(words.look.method)},
                               {"passes", std::to_string(words.look.passes)},
                               {"error", words.error},
                               {"percent", std::isdigit(static_cast<unsigned char>(words.error.back())) != 0},
                               {"flip", optional_text(words.flip)},
                               {"kind", optional_text(words.kind)},
                               {"missing", optional_text(words.missing)},
                               {"energy", optional_text(words.energy)},
                               {"shown", words.shown},
                               {"best", looks.empty()}});
    return looks;
}

/// The time after which the methods of a scene are compared [s].
std::string look_seconds(const Analysis& analysis, const std::string& scene) {
    double seconds = INFINITY;
    for (const EqualTimeLook& look : analysis.looks)
        if (look.scene == scene) seconds = std::min(seconds, look.seconds);
    return short_number(seconds);
}

data scene_data(const ReferenceQuality& quality, const std::vector<Section>& all, const Analysis& analysis) {
    const auto of_scene = [&](const Section::Row& row) { return row.scene == quality.scene; };
    std::vector<Section> words, tables;
    for (const Section& section : all)
        if (section.title != look_title) (section.columns.empty() ? words : tables).push_back(section);
    const data tables_of_scene = sections_data(tables, of_scene);
    const data looks = looks_data(analysis, quality.scene);
    return object{{"scene", quality.scene},
                  {"number", std::to_string(&quality - analysis.references.data())},
                  {"attribute", html_escape(quality.scene)},
                  {"method", quality.method},
                  {"samples", quality.samples > 0 ? data(std::to_string(quality.samples)) : data(false)},
                  {"error", quality.error_known ? data(percent_text(quality.relative_error)) : data(false)},
                  {"scene_epsilon", fmt::format("{:.4g}", quality.epsilon)},
                  {"target", quality.target ? data(percent_text(*quality.target)) : data(false)},
                  {"notes", list(quality.notes.begin(), quality.notes.end())},
                  {"cheapest", cheapest_data(quality, analysis)},
                  {"complete", tables_of_scene.is_non_empty_list()},
                  {"looks", looks},
                  {"look", looks.is_non_empty_list()},
                  {"many", looks.list_value().size() > 7},
                  {"look_seconds", look_seconds(analysis, quality.scene)},
                  {"words", sections_data(words, of_scene)},
                  {"tables", tables_of_scene}};
}

std::string counted(int count, const char* name) { return fmt::format("{} {}{}", count, name, count == 1 ? "" : "s"); }

/// Everything that the templates of table.md and of the page say in words and tables: the head, the sections over all
/// scenes with the totals alone (`sections`), and each scene with its reference and its own sections with all
/// components (`scenes`).
data page_data(const Analysis& analysis) {
    const ResultIndex& index = analysis.index;
    const std::vector<Section> all = sections(analysis);
    const auto in_table = [](const Section::Row& row) { return row.component.empty() || row.component == total_name; };
    list scenes, targets;
    for (const auto& quality : analysis.references)
        scenes.push_back(scene_data(quality, all, analysis));
    for (const std::size_t t : asked_targets)
        targets.push_back(target_names[t]);
    return object{
        {"title", index.title},
        {"plain_title", html_escape(index.title)},
        {"epsilon", index.epsilon ? fmt::format("{}", *index.epsilon)
                                  : "(0.1 m)^2, m the mean luminance of the scene's reference"},
        {"seeds", counted(index.seeds, "seed")},
        {"threads", counted(index.threads, "thread")},
        {"missing_cells", optional_text(analysis.missing_cells ? std::to_string(analysis.missing_cells) : "")},
        {"sections", sections_data(all, in_table)},
        {"targets", targets},
        {"scenes", scenes},
        {"section", std::string(embedded_file("report_page/section.html"))}};
}

/// Links to the pages of stored light, and the first command that makes one which is not there.
void add_photon_links(data& page, const Analysis& analysis, const ResultFolder& folder) {
    list pages;
    std::string command;
    for (const PhotonLink& link : photon_links(analysis.index, folder)) {
        if (!link.page.empty())
            pages.push_back(
                object{{"photon_scene", link.scene}, {"photon_method", link.method}, {"href", html_escape(link.page)}});
        else if (command.empty()) command = html_escape(link.command);
    }
    page["stores_light"] = data(!pages.empty() || !command.empty());
    page["photon_pages"] = pages;
    page["photon_command"] = optional_text(command);
    page["folder"] = html_escape(folder.path());
}

json scale_json(ColorScale colors) {
    json steps = json::array();
    for (const Color& c : colors)
        steps.push_back({std::lround(255 * c[0]), std::lround(255 * c[1]), std::lround(255 * c[2])});
    return steps;
}

}  // namespace

std::string markdown_table(const Analysis& analysis) {
    return filled(embedded_file("report_page/table.mustache"), page_data(one_label_a_method(analysis)), markdown_text);
}

std::string report_html(const Analysis& whole, const ResultFolder& folder, std::vector<std::string>* damage) {
    const Analysis analysis = one_label_a_method(whole);
    ReportPictures pictures = report_pictures(analysis, folder);
    if (damage) damage->insert(damage->end(), pictures.damage.begin(), pictures.damage.end());
    json numbers = report_data(analysis);
    numbers["pictures"] = std::move(pictures.scenes);
    numbers["pictures_note"] = pictures.note;
    numbers["scales"] = {{"error", scale_json(error_colors())},
                         {"flip", scale_json(magma_colors())},
                         {"bias", scale_json(bias_colors())}};
    data page = page_data(analysis);
    add_photon_links(page, whole, folder);
    add_tuning(folder, page, numbers);
    page["style"] = std::string(embedded_file("report_page/page.css"));
    page["data"] = script_safe_json(numbers.dump());
    page["pictures"] = pictures.elements;
    page["scripts"] = embedded_scripts({"chart.js", "report_page/core.js", "report_page/blobs.js",
                                        "report_page/charts.js", "report_page/pixels.js", "report_page/sources.js",
                                        "report_page/controls.js", "report_page/viewer.js", "report_page/gestures.js",
                                        "report_page/pyramid.js", "report_page/panel.js", "report_page/strip.js",
                                        "report_page/tuning.js", "report_page/page.js"});
    return filled(embedded_file("report_page/page.html"), page, sentence_html);
}

std::string write_report(const Analysis& analysis, const ResultFolder& folder, std::vector<std::string>* damage) {
    const std::string path = folder.file("report.html");
    write_file(path, report_html(analysis, folder, damage));
    return path;
}

}  // namespace gib
