#include "experiments/report/report.h"

#include "common/core/files.h"
#include "experiments/analysis/method_names.h"
#include "experiments/report/report_data.h"
#include "experiments/report/report_pictures.h"
#include "experiments/report/section_columns.h"
#include "experiments/report/sections.h"
#include "experiments/report/tables.h"
#include "experiments/report/words.h"
#include "experiments/results/pictures.h"
#include "experiments/text/html.h"
#include "experiments/text/numbers.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace gib {

using nlohmann::json;

namespace {

/// The place of a method's colour among those of the charts; null if it has none.
json color_of(const Analysis& analysis, const std::string& method) {
    const auto& methods = analysis.index.methods;
    const auto found = std::ranges::find(methods, method);
    return found == methods.end() ? json(nullptr) : json((found - methods.begin()) % 10);
}

json bar_data(const std::vector<double>& shares, const Section& section) {
    json bar = json::array();
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const bool stages = section.kind == Section::Kind::stages;
        bar.push_back({{"width", fmt::format("{:.1f}", 100 * shares[i])},
                       {"color", stages   ? fmt::format("stage-{}", i % 14)
                                 : i == 0 ? "bias"
                                          : "noise"},
                       {"title", stages   ? section.columns[i + 1].heading
                                 : i == 0 ? "bias^2"
                                          : "variance"}});
    }
    return bar;
}

json entry_data(const Entry& entry, const Analysis& analysis, const Section& section, std::size_t column) {
    const auto* field = std::get_if<Field>(&entry.shown);
    const FieldText text = field ? text_of(*field) : FieldText{std::get<std::string>(entry.shown), entry.remark};
    constexpr const char* marks[] = {"", " best", " tie", " never"};  // in the order of Mark
    return {{"value", text.value},
            {"detail", text.detail},
            {"tag", column == 0 ? "th" : "td"},
            {"first", column == 0},
            {"classes", (section.columns[column].of_words ? "text" : "") + std::string(marks[int(entry.mark)])},
            {"color", color_of(analysis, entry.method)},
            {"has_bar", !entry.shares.empty()},
            {"bar", bar_data(entry.shares, section)}};
}

json row_data(const Section::Row& row, const Analysis& analysis, const Section& section) {
    json fields = json::array();
    for (std::size_t i = 0; i < row.entries.size(); ++i)
        fields.push_back(entry_data(row.entries[i], analysis, section, i));
    return {{"scene", row.scene},
            {"component", row.layer ? name_of(*row.layer) : ""},
            {"sentence", row.sentence},
            {"warning", row.is_warning},
            {"fields", std::move(fields)}};
}

/// The sections with the rows for which `keeps(row)`; those without rows are left out.
template <typename Keeps>
json sections_data(const std::vector<Section>& all, const Analysis& analysis, const Keeps& keeps) {
    json sections = json::array();
    for (const Section& section : all) {
        json columns = json::array(), rows = json::array();
        for (const auto& row : section.rows)
            if (keeps(row)) rows.push_back(row_data(row, analysis, section));
        if (rows.empty()) continue;
        const bool stages = section.kind == Section::Kind::stages;
        for (std::size_t i = 0; i < section.columns.size(); ++i)
            columns.push_back({{"name", section.columns[i].heading},
                               {"words", section.columns[i].of_words},
                               {"first", i == 0},
                               {"stage", stages && i > 0 ? json((i - 1) % 14) : json(nullptr)}});
        sections.push_back({{"title", section.title},
                            {"intro", section.sentence},
                            {"by_component", section.rows.front().layer.has_value()},
                            {"table", !columns.empty()},
                            {"columns", std::move(columns)},
                            {"rows", std::move(rows)},
                            {"verdict", section.kind == Section::Kind::verdict},
                            {"bias_laws", section.kind == Section::Kind::bias_laws},
                            {"noise", section.kind == Section::Kind::noise}});
    }
    return sections;
}

json cheapest_data(const std::string& scene, const Analysis& analysis) {
    json answers = json::array();
    for (const std::size_t t : asked_targets) {
        const ShortAnswer answer = cheapest(analysis, scene, t);
        answers.push_back(
            {{"method", answer.method}, {"color", color_of(analysis, answer.method)}, {"detail", answer.detail}});
    }
    return answers;
}

/// The images of a scene at equal time, which the report's script draws beside these words.
json looks_data(const Analysis& analysis, const SceneLook& look) {
    json looks = json::array();
    for (const LookWords& words : look.methods)
        looks.push_back({{"method", words.look.method},
                         {"attribute", html_escape(words.look.method)},
                         {"color", color_of(analysis, words.look.method)},
                         {"external", analysis.index.is_external(words.look.method)},
                         {"passes", words.look.passes},
                         {"error", line_of(words.error, words.error.is_measured() ? " %" : "")},
                         {"beside", words.beside},
                         {"flip", line_of(words.flip)},
                         {"kind", words.kind},
                         {"missing", words.missing},
                         {"energy", words.energy},
                         {"shown", words.shown},
                         {"late", words.standing == Standing::no_image},
                         {"tie", words.standing == Standing::tie},
                         {"best", words.standing == Standing::best}});
    return looks;
}

json scene_data(const ReferenceQuality& quality, const std::vector<Section>& all, const Analysis& analysis) {
    const auto of_scene = [&](const Section::Row& row) { return row.scene == quality.scene; };
    std::vector<Section> words, tables;
    for (const Section& section : all)
        if (section.kind == Section::Kind::words || section.kind == Section::Kind::verdict) words.push_back(section);
        else if (section.kind != Section::Kind::looks && section.kind != Section::Kind::warnings)
            tables.push_back(section);
    json shown_tables = sections_data(tables, analysis, of_scene);
    const SceneLook look = scene_look(analysis, quality.scene);
    return {{"scene", quality.scene},
            {"number", &quality - analysis.references.data()},
            {"attribute", html_escape(quality.scene)},
            {"method", quality.method},
            {"samples", quality.samples > 0 ? json(quality.samples) : json(nullptr)},
            {"error", quality.error_known ? percent_text(quality.relative_error) : ""},
            {"scene_epsilon", fmt::format("{:.4g}", quality.epsilon)},
            {"target", quality.target ? percent_text(*quality.target) : ""},
            {"notes", quality.notes},
            {"cheapest", cheapest_data(quality.scene, analysis)},
            {"complete", !shown_tables.empty()},
            {"looks", looks_data(analysis, look)},
            {"look", !look.methods.empty()},
            {"many", look.methods.size() > 7},
            {"look_seconds", short_number(look.seconds)},
            {"words", sections_data(words, analysis, of_scene)},
            {"tables", std::move(shown_tables)}};
}

/// The meanings of the tables' headings, by their declarations.
json meanings_data() {
    json meanings = json::array();
    for (const SectionColumn& column : section_columns())
        if (const std::string meaning = column.meaning(); !meaning.empty())
            meanings.push_back({{"heading", column.heading}, {"meaning", meaning}});
    return meanings;
}

std::string counted(int count, const char* name) { return fmt::format("{} {}{}", count, name, count == 1 ? "" : "s"); }

std::string missing_text(int cells) {
    return fmt::format("{} of the experiment {} not complete.", counted(cells, "cell"), cells == 1 ? "is" : "are");
}

/// Everything that the templates of table.md and of the page say in words and tables: the head, the sections over all
/// scenes with the totals alone (`sections`), and each scene with its reference and its own sections with all
/// components (`scenes`).
json page_data(const Analysis& analysis) {
    const ResultIndex& index = analysis.index;
    const std::vector<Section> all = sections(analysis);
    const auto in_table = [](const Section::Row& row) { return row.layer.value_or(Layer::total) == Layer::total; };
    json scenes = json::array(), targets = json::array(), warnings = json::array();
    for (const Warning& w : analysis.warnings)
        warnings.push_back(about_scene(w.scene, sentence_of(w)));
    for (const auto& quality : analysis.references)
        scenes.push_back(scene_data(quality, all, analysis));
    for (const std::size_t t : asked_targets)
        targets.push_back(target_names[t]);
    return {{"title", index.title},
            {"plain_title", html_escape(index.title)},
            {"epsilon", index.epsilon ? fmt::format("{}", *index.epsilon)
                                      : "(0.1 m)^2, m the mean luminance of the scene's reference"},
            {"seeds", counted(index.seeds, "seed")},
            {"threads", counted(index.threads, "thread")},
            {"missing_cells",
             analysis.missing_cells > 0 ? json(missing_text(static_cast<int>(analysis.missing_cells))) : json(nullptr)},
            {"warnings", warnings},
            {"sections", sections_data(all, analysis, in_table)},
            {"targets", targets},
            {"meanings", meanings_data()},
            {"scenes", scenes},
            {"section", embedded_file("report_page/section.html")}};
}

/// Links to the pages of stored light, and the first command that makes one which is not there.
void add_photon_links(json& page, const Analysis& analysis, const ResultFolder& folder) {
    namespace fs = std::filesystem;
    json pages = json::array();
    std::string command;
    const auto names = names_of_methods_that_store_light();
    for (const IndexScene& scene : analysis.index.scenes)
        for (const std::string& method : analysis.index.methods) {
            if (std::ranges::find(names, MethodLabel::parse(method).name) == names.end()) continue;
            fs::path file = folder.method_image(scene.name, method);
            file.replace_extension();  // without the image's ending
            file += "-photons.html";
            if (fs::exists(file))
                pages.push_back({{"photon_scene", scene.name},
                                 {"photon_method", method},
                                 {"href", html_escape("images/" + file.filename().string())}});
            else if (command.empty())
                command = html_escape(
                    fmt::format("gibench photons '{}' --method '{}' -o '{}'", scene.path, method, file.string()));
        }
    page["stores_light"] = !pages.empty() || !command.empty();
    page["photon_pages"] = pages;
    page["photon_command"] = command;
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
    return filled(embedded_file("report_page/table.mustache"),
                  page_data(with_short_names(one_label_a_method(analysis))), markdown_text);
}

void write_tables(const Analysis& analysis, const ResultFolder& folder) {
    write_file(folder.file("curves.csv"), curves_table(analysis).text());
    write_file(folder.file("table.csv"), error_table(analysis).text());
    write_file(folder.file("table.md"), markdown_table(analysis));
    write_file(folder.file("spectra.csv"), spectra_table(analysis).text());
    write_file(folder.file("stages.csv"), stages_table(analysis).text());
    write_file(folder.file("bias_laws.csv"), bias_law_table(analysis).text());
}

std::string report_html(const Analysis& whole, const ResultFolder& folder, std::vector<std::string>* damage) {
    const Analysis analysis = with_short_names(one_label_a_method(whole));
    ReportPictures pictures = report_pictures(analysis, folder);
    if (damage) damage->insert(damage->end(), pictures.damage.begin(), pictures.damage.end());
    json numbers = report_data(analysis);
    numbers["pictures"] = std::move(pictures.scenes);
    numbers["pictures_note"] = pictures.note;
    numbers["scales"] = {{"error", scale_json(error_colors())},
                         {"flip", scale_json(magma_colors())},
                         {"bias", scale_json(bias_colors())}};
    json page = page_data(analysis);
    add_photon_links(page, whole, folder);
    add_tuning(folder, page, numbers);
    page["style"] =
        std::string(embedded_file("report_page/scheme.css")) + std::string(embedded_file("report_page/page.css"));
    page["data"] = script_safe_json(numbers.dump());
    page["pictures"] = pictures.elements;
    page["chart_script"] = embedded_scripts({"chart.js"});
    page["script"] = embedded_scripts({"report_page/core.js", "report_page/controls.js", "report_page/blobs.js",
                                       "report_page/charts.js", "report_page/pixels.js", "report_page/sources.js",
                                       "report_page/viewer.js", "report_page/gestures.js", "report_page/pyramid.js",
                                       "report_page/panel.js", "report_page/strip.js", "report_page/sweeps.js",
                                       "report_page/tuning.js", "report_page/page.js"});
    return filled(embedded_file("report_page/page.html"), page, sentence_html);
}

std::string write_report(const Analysis& analysis, const ResultFolder& folder, std::vector<std::string>* damage) {
    const std::string path = folder.file("report.html");
    write_file(path, report_html(analysis, folder, damage));
    return path;
}

}  // namespace gib
