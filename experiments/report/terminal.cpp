#include "experiments/report/terminal.h"

#include "experiments/analysis/curves.h"
#include "experiments/analysis/method_names.h"
#include "experiments/report/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace gib {

namespace {

// The head takes a line, and so does the name of the only scene.
constexpr std::size_t most_lines = 12, most_columns = 80;

struct Line {
    std::string scene, error, method, seconds, factor, consists_of;
};

/// The place at or after `at` where a character begins.
std::size_t character_at(const std::string& text, std::size_t at) {
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0u) == 0x80u)
        ++at;
    return at;
}

/// The text, cut to `width` bytes: its beginning and the last `tail` bytes, which hold the settings that differ.
std::string cut(const std::string& text, std::size_t width, std::size_t tail = 0) {
    if (text.size() <= width) return text;
    std::size_t head = width - 2 - tail;
    while (head > 0 && character_at(text, head) != head)
        --head;
    return text.substr(0, head) + ".." + text.substr(character_at(text, text.size() - tail));
}

/// The first items of a list, at most `width` characters of them.
std::string cut_list(const std::string& text, std::size_t width) {
    constexpr std::string_view rest = ", ..";
    if (text.size() <= width || width < rest.size()) return text;
    return text.substr(0, text.rfind(", ", width - rest.size())) + std::string(rest);
}

Line line_of(const std::string& scene, const VerdictRow& v) {
    const std::string of = v.parts.empty() || v.kind.empty() ? v.parts + v.kind : v.parts + "; " + v.kind;
    const bool is_extrapolated = v.seconds.state == State::extrapolated;
    const bool has_error = !v.seconds.is_measured() && !is_extrapolated && v.error.is_measured();
    const std::string beside =
        has_error ? fmt::format("{:.2g} %", 100 * std::sqrt(v.error.value)) : text_of(v.factor).value;
    return {.scene = scene,
            .error = v.target ? std::string(target_names[*v.target]) + " %" : "any",
            .method = v.method,
            .seconds = v.seconds.state == State::below_noise
                           ? "below noise"
                           : text_of(v.seconds).value + (is_extrapolated ? " extrap." : ""),
            .factor = beside + (v.is_tie ? " n.s." : ""),
            .consists_of = !v.method.empty() ? of : (v.target ? "none: " : "no verdict: ") + v.remark};
}

std::size_t width_of(const std::vector<Line>& lines, std::string Line::*column, std::size_t most) {
    std::size_t width = 0;
    for (const Line& line : lines)
        width = std::max(width, (line.*column).size());
    return std::min(width, most);
}

}  // namespace

std::string terminal_verdict(const Analysis& whole) {
    const Analysis analysis = with_short_names(one_label_a_method(whole));
    std::vector<Line> all, best;
    for (const std::string& scene : scenes_of(analysis)) {
        std::optional<std::size_t> last = most_lines;  // no target
        for (const VerdictRow& v : verdict(analysis, scene)) {
            all.push_back(line_of(scene, v));
            if (v.target != last) best.push_back(all.back());
            last = v.target;
        }
    }
    if (all.empty()) return "";
    const bool has_ties = std::ranges::any_of(all, [](const Line& l) { return l.factor.ends_with("n.s."); });
    const std::size_t room = most_lines - (has_ties ? 3 : 2);
    std::vector<Line> lines = all.size() <= room ? all : best;
    const std::size_t more = lines.size() > room ? lines.size() - (room - 1) : 0;
    lines.resize(lines.size() - more);
    lines.insert(lines.begin(), {"scene", "to", "method", "seconds", "times or RMSE", "its error is"});
    // One scene needs no column.
    const bool has_scenes = std::ranges::any_of(all, [&](const Line& l) { return l.scene != all[0].scene; });
    const std::size_t scene = has_scenes ? width_of(lines, &Line::scene, 16) + 1 : 0,
                      error = width_of(lines, &Line::error, 5), method = width_of(lines, &Line::method, 28),
                      seconds = width_of(lines, &Line::seconds, 14), factor = width_of(lines, &Line::factor, 14);
    std::string text = has_scenes ? "" : all[0].scene + "\n";
    for (const Line& line : lines) {
        std::string row =
            fmt::format("{:<{}}{:>{}}  ", has_scenes ? cut(line.scene, scene - 1) : "", scene, line.error, error);
        if (!line.method.empty())
            row += fmt::format("{:<{}} {:>{}} {:>{}}  ", cut(line.method, method, method / 2), method,
                               cut(line.seconds, seconds), seconds, cut(line.factor, factor), factor);
        const std::size_t left = most_columns - std::min(row.size(), most_columns);
        std::string shown = cut(row + cut_list(line.consists_of, left), most_columns);
        shown.erase(shown.find_last_not_of(' ') + 1);
        text += shown + "\n";
    }
    if (has_ties) text += "n.s.: not significantly different from the best; beside the best: another method is not\n";
    if (more > 0) text += fmt::format("and {} more in table.md\n", more);
    return text;
}

}  // namespace gib
