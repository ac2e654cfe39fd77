#include "experiments/report/report.h"

#include "common/core/files.h"
#include "experiments/analysis/footing_warnings.h"
#include "experiments/report/price_text.h"
#include "experiments/report/report_assets.h"
#include "experiments/report/report_data.h"
#include "experiments/report/report_pictures.h"
#include "experiments/report/report_tables.h"
#include "experiments/results/color_maps.h"
#include "experiments/text/html.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace gib {

using nlohmann::json;

namespace {

std::string note_html(const std::string& text) { return fmt::format("<p class=\"note\">{}</p>\n", html_escape(text)); }

/// The warnings about methods whose mean energy differs from the reference's. They stand before the scene's numbers.
std::string footing_html(const Analysis& analysis, const std::string& scene) {
    std::string differ, unresolved;
    int count = 0;
    for (const FootingWarning& warning : footing_warnings(analysis)) {
        if (warning.scene != scene) continue;
        const std::string text = "<li>" + sentence_html(warning.text) + ".</li>\n";
        if (warning.differs) differ += text;
        else unresolved += text, ++count;
    }
    std::string html;
    if (!differ.empty())
        html +=
            "<div class=\"note\" role=\"note\"><b>Not on an equal footing.</b> Mean energy differs from the "
            "reference's, with 99 % intervals:<ul>\n" +
            differ + "</ul></div>\n";
    if (count > 0)
        html += fmt::format(
            "<details><summary>Equal footing: {} component{} cannot be told to agree</summary><ul>\n{}"
            "</ul></details>\n",
            count, count == 1 ? "" : "s", unresolved);
    return html;
}

std::string answers_html(const Analysis& analysis, const std::string& scene) {
    std::string html;
    for (const PriceAnswer& answer : price_answers(analysis))
        if (answer.scene == scene) html += "<li>" + sentence_html(answer.text) + "</li>\n";
    return html.empty() ? "" : "<ul class=\"answers\">\n" + html + "</ul>\n";
}

std::string reference_html(const ReferenceQuality& quality) {
    return fmt::format(
        "<p class=\"muted\">Reference: {}, {} samples a pixel, its own relative standard error {} %{}.</p>\n",
        html_escape(quality.method), quality.samples, percent_text(quality.relative_error),
        quality.target ? fmt::format(" (target {} %)", percent_text(*quality.target)) : "");
}

std::string scene_html(const Analysis& analysis, const std::vector<Crossover>& changes, const ReferenceQuality& quality,
                       std::size_t number) {
    const std::string& scene = quality.scene;
    std::string html = fmt::format("<section class=\"scene\" id=\"scene-{}\" data-scene=\"{}\">\n<h2>{}</h2>\n{}",
                                   number, html_escape(scene), html_escape(scene), reference_html(quality));
    for (const auto& note : quality.notes)
        html += note_html(note);
    const bool any =
        std::any_of(analysis.rows.begin(), analysis.rows.end(), [&](const auto& row) { return row.scene == scene; });
    if (!any) return html + "<p>No cell of this scene is complete.</p>\n</section>\n";
    html += answers_html(analysis, scene) + footing_html(analysis, scene);
    html += "<div class=\"controls scene-controls\"></div>\n";
    html += "<h3>Price list: seconds to reach an error</h3>\n" + price_list_html(analysis, scene);
    html += "<div class=\"charts\"><div class=\"curve-chart\"></div></div>\n";
    html += crossovers_html(analysis, changes, scene);
    html += "<h3>What more accuracy costs</h3>\n" + laws_html(analysis, scene);
    html += "<h3>Images</h3>\n<div class=\"viewer\"><noscript><p>The images need scripts.</p></noscript></div>\n";
    html += "<h3>Bias and noise</h3>\n" + split_html(analysis, scene);
    html += "<div class=\"charts\"><div class=\"noise-chart\"></div><div class=\"bias-chart\"></div></div>\n";
    html += "<h3>Where the time goes</h3>\n" + stages_html(analysis, scene);
    return html + "</section>\n";
}

json scale_json(ColorScale colors) {
    json steps = json::array();
    for (const Color& c : colors)
        steps.push_back({std::lround(255 * c[0]), std::lround(255 * c[1]), std::lround(255 * c[2])});
    return steps;
}

std::string summary_html(const Analysis& analysis) {
    const ResultIndex& index = analysis.index;
    std::string html =
        fmt::format("<p class=\"muted\">{} seed{} &middot; {} thread{} &middot; epsilon {}</p>\n", index.seeds,
                    index.seeds == 1 ? "" : "s", index.threads, index.threads == 1 ? "" : "s", index.epsilon);
    if (analysis.missing_cells > 0)
        html += note_html(fmt::format("{} cells of the experiment are not complete.", analysis.missing_cells));
    return html;
}

std::string scripts_html() {
    std::string html;
    for (const auto& asset : report_scripts())
        html += "<script>\n" + script_safe_code(asset) + "\n</script>\n";
    return html;
}

/// Replaces every {{NAME}} in one pass, so that inserted text is never searched.
std::string filled(std::string_view page, const std::map<std::string, std::string>& values) {
    std::string text;
    while (true) {
        const std::size_t begin = page.find("{{");
        text += page.substr(0, begin);
        if (begin == std::string_view::npos) return text;
        const std::size_t end = page.find("}}", begin);
        text += values.at(std::string(page.substr(begin + 2, end - begin - 2)));
        page.remove_prefix(end + 2);
    }
}

}  // namespace

std::string report_html(const Analysis& analysis, const ResultFolder& folder, std::vector<std::string>* damage) {
    ReportPictures pictures = report_pictures(analysis, folder);
    if (damage) damage->insert(damage->end(), pictures.damage.begin(), pictures.damage.end());
    json data = report_data(analysis);
    data["pictures"] = std::move(pictures.scenes);
    data["pictures_note"] = pictures.note;
    data["scales"] = {{"error", scale_json(error_colors())},
                      {"flip", scale_json(magma_colors())},
                      {"bias", scale_json(bias_colors())}};
    const std::vector<Crossover> changes = crossovers(analysis);
    std::string scenes;
    for (std::size_t i = 0; i < analysis.references.size(); ++i)
        scenes += scene_html(analysis, changes, analysis.references[i], i);
    return filled(report_page(), {{"TITLE", html_escape(analysis.index.title)},
                                  {"STYLE", std::string(report_style())},
                                  {"SUMMARY", summary_html(analysis)},
                                  {"OVERVIEW", overview_html(analysis)},
                                  {"SCENES", scenes},
                                  {"DATA", script_safe_json(data.dump())},
                                  {"PICTURES", pictures.elements},
                                  {"SCRIPTS", scripts_html()}});
}

std::string write_report(const Analysis& analysis, const ResultFolder& folder, std::vector<std::string>* damage) {
    const std::string path = folder.file("report.html");
    write_file(path, report_html(analysis, folder, damage));
    return path;
}

}  // namespace gib
