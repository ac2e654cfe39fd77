#include "experiments/report.h"

#include "common/files.h"
#include "common/image_file.h"
#include "experiments/judgement.h"
#include "experiments/report_images.h"
#include "experiments/report_plot.h"
#include "experiments/report_template.h"
#include "experiments/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace gib {

namespace {

/// Relative errors from here on have the brightest colour of an error map.
constexpr double map_scale = 0.25;

std::string interval_html(const std::optional<Interval>& interval, std::string (*text)(double)) {
    return interval ? fmt::format("<span class=\"interval\">({} to {})</span>", text(std::max(0.0, interval->lo)),
                                  text(std::max(0.0, interval->hi)))
                    : "";
}

std::string root_percent(double rel_mse) { return percent_text(std::sqrt(std::max(0.0, rel_mse))); }

std::string table_row(const TableRow& row) {
    const bool total = row.component == total_name;
    const auto& s = row.statistics;
    const auto cell = [](const std::string& text) { return "<td>" + text + "</td>"; };
    std::string html = fmt::format("<tr{}><td>{}</td>", total ? "" : " class=\"part\"",
                                   html_escape(total ? row.method : row.component));
    html += cell(total ? short_number(row.seconds) : "");
    html += cell(s ? root_percent(s->rel_mse.value) + interval_html(s->rel_mse.interval, root_percent) : "not judged");
    html += cell(s && s->bias2 ? short_number(std::max(0.0, s->bias2->value)) : "");
    html += cell(s && s->variance ? short_number(s->variance->value) : "");
    html += cell(row.times[1] ? short_number(row.times[1]->value) + interval_html(row.times[1]->interval, short_number)
                              : "");
    html += cell(row.noise ? short_number(row.noise->centroid) : "");
    html += cell(row.noise ? short_number(row.noise->low_ratio) : "");
    html += cell(total ? fmt::format("{:.0f} MiB", row.peak_rss_mib) : "");
    html += fmt::format("<td class=\"text\">{}</td></tr>\n", total ? html_escape(row.effects_missing) : "");
    return html;
}

std::string table_html(const Analysis& analysis, const std::string& scene) {
    std::string html =
        "<div class=\"scroll\"><table>\n<tr><th>method</th><th>seconds</th><th>relative RMSE %</th><th>bias&sup2;</th>"
        "<th>variance</th><th>time to 5 %</th><th>noise centroid</th><th>low frequencies</th><th>memory</th>"
        "<th class=\"text\">missing</th></tr>\n";
    for (const auto& row : analysis.rows)
        if (row.scene == scene) html += table_row(row);
    return html + "</table></div>\n";
}

/// The mean over seeds at the passes that all of them have: time, and the root of the mean relative squared error.
PlotLine line_of(const Analysis& analysis, const std::string& scene, const std::string& method) {
    struct Sum {
        int seeds = 0;
        double seconds = 0, rel_mse = 0;
    };
    std::map<std::uint32_t, Sum> sums;
    int seeds = 0;
    for (const Cell& cell : analysis.cells) {
        if (cell.scene != scene || cell.method != method) continue;
        ++seeds;
        for (const auto& [checkpoint, errors] : cell.checkpoints) {
            const auto total = errors.find(total_name);
            if (total == errors.end()) continue;
            Sum& sum = sums[checkpoint.passes];
            ++sum.seeds;
            sum.seconds += checkpoint.seconds;
            sum.rel_mse += total->second.rel_mse;
        }
    }
    PlotLine line{method, {}};
    for (const auto& [passes, sum] : sums)
        if (sum.seeds == seeds) line.points.push_back({sum.seconds / seeds, 100 * std::sqrt(sum.rel_mse / seeds)});
    return line;
}

std::string plot_html(const Analysis& analysis, const std::string& scene) {
    std::vector<PlotLine> lines;
    for (const auto& method : analysis.index.methods)
        lines.push_back(line_of(analysis, scene, method));
    std::string html =
        "<div class=\"plot\">" + log_log_plot(lines, "seconds", "relative RMSE %") + "<ul class=\"legend\">";
    for (std::size_t i = 0; i < lines.size(); ++i)
        html += fmt::format("<li><span class=\"swatch\" style=\"background:{}\"></span>{}</li>", line_color(i),
                            html_escape(lines[i].name));
    return html + "</ul></div>\n";
}

std::string image_tag(const std::string& url, const Image& size, const std::string& description) {
    return fmt::format("<img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\">", url, size.width, size.height,
                       html_escape(description));
}

std::string image_tag(const Image& image, float exposure, const std::string& description) {
    return image_tag(png_data_url(image, exposure), image, description);
}

/// Empty if it was not measured.
std::string flip_tag(const ResultFolder& folder, const TableRow& row, const Image& image) {
    const std::string path = folder.flip_map(cell_folder_name(row.scene, row.method, 1));
    if (!std::filesystem::exists(path)) return "";
    return image_tag(png_data_url(read_file(path)), image, "FLIP of " + row.method);
}

std::string images_html(const Analysis& analysis, const ResultFolder& folder, const std::string& scene) {
    const Reference reference = read_reference(folder.reference_image(scene));
    const Judgement judgement(reference);
    const Image& r = reference.total.mean;
    const float exposure = exposure_for(r);
    std::string html =
        fmt::format("<div class=\"images\">\n<figure>{}<figcaption><b>reference</b></figcaption></figure>\n",
                    image_tag(r, exposure, "reference of " + scene));
    for (const auto& row : analysis.rows) {
        if (row.scene != scene || row.component != total_name) continue;
        const std::string path = folder.method_image(scene, row.method);
        if (!std::filesystem::exists(path)) continue;
        const ComponentImages image = components_in(read_image(path));
        const Image map =
            error_map(judgement.total_of(image), judgement.total().mean, analysis.index.epsilon, map_scale);
        html += fmt::format("<figure>{}{}{}<figcaption><b>{}</b>{} % in {} s{}</figcaption></figure>\n",
                            image_tag(image.total(), exposure, row.method + " on " + scene),
                            image_tag(map, 1.f, "error of " + row.method), flip_tag(folder, row, map),
                            html_escape(row.method), row.statistics ? root_percent(row.statistics->rel_mse.value) : "",
                            short_number(row.seconds), row.flip ? ", FLIP " + short_number(*row.flip) : "");
    }
    html += "</div>\n";
    html += fmt::format(
        "<div class=\"muted\" style=\"margin-top:.8rem\">Below each image (seed 1): relative error of a pixel<div "
        "class=\"scale\"></div>"
        "<div class=\"scale-ends\"><span>0</span><span>{:.0f} % and more</span></div>Below that: FLIP, how much of a "
        "difference a viewer sees who flips between image and reference on a screen with 67 pixels per degree<div "
        "class=\"scale magma\"></div><div class=\"scale-ends\"><span>0: none</span><span>1: the largest a screen can "
        "show</span></div></div>\n",
        100 * map_scale);
    return html;
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

std::string stages_html(const Analysis& analysis, const std::string& scene) {
    std::map<std::string, std::size_t> colors;
    std::string bars;
    double longest = 0;
    for (const auto& row : analysis.rows)
        if (row.scene == scene) longest = std::max(longest, row.seconds);
    for (const auto& row : analysis.rows) {
        if (row.scene != scene || row.component != total_name) continue;
        bars += fmt::format("<div>{}</div><div class=\"bar\">", html_escape(row.method));
        for (const auto& stage : mean_stages(analysis, scene, row.method)) {
            const std::size_t color = colors.emplace(stage.name, colors.size()).first->second;
            bars += fmt::format("<span class=\"part\" style=\"width:{:.2f}%;background:{}\" title=\"{}: {} s\"></span>",
                                80 * stage.seconds / std::max(longest, 1e-12), line_color(color),
                                html_escape(stage.name), short_number(stage.seconds));
        }
        bars += fmt::format("<span style=\"margin-left:.7rem\">{} s</span></div>\n", short_number(row.seconds));
    }
    std::string legend = "<ul class=\"legend\">";
    for (const auto& [name, color] : colors)
        legend += fmt::format("<li><span class=\"swatch\" style=\"background:{}\"></span>{}</li>", line_color(color),
                              html_escape(name));
    return "<div class=\"stages\">\n" + bars + "</div>\n" + legend + "</ul>\n";
}

std::string scene_html(const Analysis& analysis, const ResultFolder& folder, const ReferenceQuality& quality) {
    const std::string& scene = quality.scene;
    std::string html = fmt::format(
        "<section>\n<h2>{}</h2>\n<p class=\"muted\">Reference: {}, {} samples a pixel, its own relative standard error "
        "{} %{}.</p>\n",
        html_escape(scene), html_escape(quality.method), quality.samples, percent_text(quality.relative_error),
        quality.target ? fmt::format(" (target {} %)", percent_text(*quality.target)) : "");
    for (const auto& note : quality.notes)
        html += fmt::format("<p class=\"note\">{}</p>\n", html_escape(note));
    const bool any =
        std::any_of(analysis.rows.begin(), analysis.rows.end(), [&](const auto& row) { return row.scene == scene; });
    if (!any) return html + "<p>No cell of this scene is complete.</p>\n</section>\n";
    html += table_html(analysis, scene);
    html += "<h3>Error against time</h3>\n" + plot_html(analysis, scene);
    html += "<h3>Images</h3>\n" + images_html(analysis, folder, scene);
    html += "<h3>Where the time goes</h3>\n" + stages_html(analysis, scene);
    return html + "</section>\n";
}

/// Replaces every {{NAME}}; one pass, so that inserted text is never searched.
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

std::string report_html(const Analysis& analysis, const ResultFolder& folder) {
    const ResultIndex& index = analysis.index;
    std::string summary = fmt::format("<p class=\"muted\">Seeds: {} &middot; threads: {} &middot; epsilon: {}</p>\n",
                                      index.seeds, index.threads, index.epsilon);
    if (analysis.missing_cells > 0)
        summary +=
            fmt::format("<p class=\"note\">{} cells of the experiment are not complete.</p>\n", analysis.missing_cells);
    std::string scenes;
    for (const auto& quality : analysis.references)
        scenes += scene_html(analysis, folder, quality);
    return filled(report_template(), {{"TITLE", html_escape(index.title)}, {"SUMMARY", summary}, {"SCENES", scenes}});
}

std::string write_report(const Analysis& analysis, const ResultFolder& folder) {
    const std::string path = folder.file("report.html");
    write_file(path, report_html(analysis, folder));
    return path;
}

}  // namespace gib
