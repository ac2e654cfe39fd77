#include "experiments/analysis/warnings.h"

#include "experiments/analysis/method_names.h"
#include "experiments/plan/experiment_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace gib {

namespace {

/// A cell had a busy machine if its threads waited for a processor for more than this share of the time for which they
/// ran. On an idle machine the share is below 0.01.
constexpr double largest_wait = 0.1;
/// Seeds do the same work in a pass, but for the scatter of their paths: their times for it differ by less than this
/// factor, if they take `least_seconds` or more.
constexpr double largest_ratio = 1.3, least_seconds = 0.2;

double waited(const Cell& cell) {
    return cell.processor_seconds > 0 ? cell.waiting_seconds / cell.processor_seconds : 0;
}

double seconds_of_a_pass(const Cell& cell) { return (cell.last().seconds - cell.prepare_seconds) / cell.last().passes; }

/// A share in percent with its interval, as in "-0.40 % (-3.10 to +2.30)".
std::string signed_percent(const Estimate& e) {
    return fmt::format("{:+.2f} %", 100 * e.value) +
           (e.interval ? fmt::format(" ({:+.2f} to {:+.2f})", 100 * e.interval->lo, 100 * e.interval->hi) : "");
}

/// Whether the images of a row are black where the reference is not.
bool is_black(const TableRow& row) {
    return row.balance && row.balance->energy.value == 0 && row.balance->excess.value < 0;
}

std::string component_text(const TableRow& row) {
    const Estimate& excess = row.balance->excess;
    return fmt::format("`{}` {}", name_of(row.layer),
                       is_black(row)                 ? "is black"
                       : std::isfinite(excess.value) ? signed_percent(excess)
                                                     : "is not finite");
}

/// The two rows that differ most surely from each other, among
/// the rows of one component whose energy balance is inconclusive.
struct Disagreement {
    const TableRow *more = nullptr, *less = nullptr;
    Estimate difference;  ///< with an interval
    double sureness = 0;  ///< difference / half the width of its interval
};

void consider(const TableRow& a, const TableRow& b, std::optional<Disagreement>& surest) {
    const EnergyBalance pair = a.balance->against(*b.balance);
    if (pair.verdict != BalanceVerdict::differs || !pair.excess.interval) return;
    if (pair.excess.value < 0) return consider(b, a, surest);
    const double half = pair.excess.interval->hi - pair.excess.value;
    const double sureness = half > 0 ? pair.excess.value / half : std::numeric_limits<double>::infinity();
    if (!surest || sureness > surest->sureness)
        surest = Disagreement{.more = &a, .less = &b, .difference = pair.excess, .sureness = sureness};
}

/// The rows whose energy balance is inconclusive, by scene and component.
using InconclusiveRows = std::map<std::pair<std::string, Layer>, std::vector<const TableRow*>>;

std::vector<Warning> disagreements(const InconclusiveRows& groups) {
    std::vector<Warning> warnings;
    for (const auto& [key, rows] : groups) {
        std::optional<Disagreement> surest;
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                consider(*rows[i], *rows[j], surest);
        if (!surest) continue;
        warnings.push_back(
            {.kind = Warning::Kind::energy_differs,
             .scene = key.first,
             .sentence = fmt::format(
                 "methods differ in mean energy of `{}`, in which the reference is inconclusive: {} has {} over {}",
                 name_of(key.second), surest->more->method, signed_percent(surest->difference), surest->less->method)});
    }
    return warnings;
}

}  // namespace

std::set<std::string> processors_of(const Runs& cells) {
    std::set<std::string> names;
    for (const Cell* cell : cells)
        if (!cell->cpu.empty()) names.insert(cell->cpu);
    return names;
}

std::optional<Warning> unlike_processors(const std::vector<Cell>& cells, const std::string& scene) {
    std::map<std::string, std::set<std::string>> methods;  // by the processor's name
    for (const Cell& cell : cells)
        if (cell.scene == scene && !cell.cpu.empty()) methods[cell.cpu].insert(cell.method);
    if (methods.size() < 2) return std::nullopt;
    std::string text = "the cells were measured on different processors: their seconds do not compare";
    for (const auto& [cpu, labels] : methods)
        text += fmt::format("; on '{}': {}", cpu, fmt::join(labels, ", "));
    return Warning{.kind = Warning::Kind::unlike_processors, .scene = scene, .sentence = text};
}

std::string busy_sign(const Analysis& analysis, const std::string& method, const Runs& cells) {
    if (analysis.index.is_external(method)) return "";
    const double longest = waited(**std::ranges::max_element(cells, {}, [](const Cell* c) { return waited(*c); }));
    if (longest > largest_wait) return fmt::format("threads waited {:.2g} s for each second that they ran", longest);
    double least = seconds_of_a_pass(*cells.front()), most = least, shortest = cells.front()->last().seconds;
    std::uint32_t least_passes = cells.front()->last().passes, most_passes = least_passes;
    for (const Cell* cell : cells) {
        least = std::min(least, seconds_of_a_pass(*cell));
        most = std::max(most, seconds_of_a_pass(*cell));
        shortest = std::min(shortest, cell->last().seconds);
        least_passes = std::min(least_passes, cell->last().passes);
        most_passes = std::max(most_passes, cell->last().passes);
    }
    if (shortest < least_seconds || !(most > largest_ratio * least)) return "";
    return fmt::format("a pass takes {:.3g} s to {:.3g} s, {} passes{}", least, most, least_passes,
                       most_passes > least_passes ? fmt::format(" to {}", most_passes) : "");
}

bool calls_for_equal_passes(const Analysis& analysis, const std::string& scene) {
    const auto methods = cells_by_method(analysis, scene);
    return !has_time_budget(analysis.index.experiment_text) || std::ranges::any_of(methods, [&](const auto& method) {
        return !busy_sign(analysis, method.first, method.second).empty();
    });
}

std::optional<Warning> busy_machine(const Analysis& analysis, const std::string& run_command) {
    const std::vector<std::string> scenes = scenes_of(analysis);
    std::set<std::string> busy_scenes, busy_methods;
    std::string signs;
    std::size_t count = 0;
    auto names = short_names(analysis);
    for (const std::string& scene : scenes)
        for (const auto& [method, cells] : cells_by_method(analysis, scene)) {
            const std::string sign = busy_sign(analysis, method, cells);
            if (sign.empty()) continue;
            busy_scenes.insert(scene);
            busy_methods.insert(method);
            const std::string& name = names.try_emplace(method, method).first->second;
            if (++count <= 2)
                signs += fmt::format("{}{}{}: {}", signs.empty() ? "" : "; ", scenes.size() > 1 ? scene + ", " : "",
                                     name, sign);
        }
    if (count == 0) return std::nullopt;
    if (count > 2) signs += fmt::format("; and {} more", count - 2);
    Warning warning{.kind = Warning::Kind::busy_machine,
                    .scene = "",
                    .sentence = fmt::format("the machine was busy: seconds are too long ({})", signs)};
    // --only names one method by its label, or all cells of one scene.
    const std::string only = busy_methods.size() == 1  ? fmt::format(" --only '{}'", *busy_methods.begin())
                             : busy_scenes.size() == 1 ? fmt::format(" --only '{}'", *busy_scenes.begin())
                                                       : "";
    if (run_command.empty()) warning.sentence += "; the same tuning into another folder (`--out`) measures anew";
    else warning.command = fmt::format("{}{} --fresh", run_command, only);
    return warning;
}

std::string contradiction(const Analysis& analysis, const TableRow& total) {
    std::string text;
    for (const Layer layer : total.contradicted_in)
        if (const TableRow* row = analysis.row(total.scene, total.method, layer))
            text += (text.empty() ? "" : ", ") + component_text(*row);
    return "biased, although declared unbiased: mean energy relative to the reference's " + text;
}

std::vector<Warning> contradicted_declarations(const Analysis& analysis, const std::string& scene) {
    std::vector<Warning> warnings;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.layer == Layer::total && !row.contradicted_in.empty())
            warnings.push_back({.kind = Warning::Kind::declaration_contradicted,
                                .scene = scene,
                                .sentence = fmt::format("{} is {}", row.method, contradiction(analysis, row))});
    return warnings;
}

std::vector<Warning> balance_warnings(const Analysis& analysis) {
    std::vector<Warning> differing;
    InconclusiveRows groups;
    const TableRow* last = nullptr;
    for (const TableRow& row : analysis.rows) {
        // Excluded: methods that leave out light of the component, for a known reason; equal images, without an
        // interval; images with unsampled light.
        if (row.has_verdict(BalanceVerdict::inconclusive) && row.effects_missing.empty() &&
            !row.components_missing.touches(row.layer) && row.balance->excess.interval && !row.balance->misses_light)
            groups[{row.scene, row.layer}].push_back(&row);
        // Black images need no interval, unless theory says that they have only missed the light so far.
        const bool all_black = row.layer == Layer::total && is_black(row) && !row.is_unbiased;
        if (!row.has_verdict(BalanceVerdict::differs) && !all_black) continue;
        // Rows of one method are joined in one sentence.
        if (last && last->scene == row.scene && last->method == row.method)
            differing.back().sentence += ", " + component_text(row);
        else
            differing.push_back(
                {.kind = Warning::Kind::energy_differs,
                 .scene = row.scene,
                 .sentence = fmt::format(
                     "{}{} differs from the reference in mean energy: {}", row.method,
                     row.effects_missing.empty() ? "" : ", which leaves out " + words_of(row.effects_missing) + ",",
                     component_text(row))});
        last = &row;
    }
    for (auto& warning : disagreements(groups))
        differing.push_back(std::move(warning));
    return differing;
}

}  // namespace gib
