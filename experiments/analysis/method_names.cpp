#include "experiments/analysis/method_names.h"

#include "common/core/number_text.h"
#include "experiments/plan/label_checks.h"
#include "methods/parameters.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace gib {

namespace {

using GivenValue = std::pair<std::string, std::string>;

std::string joined(const std::vector<GivenValue>& settings, const std::string& before, const std::string& between) {
    std::string text;
    for (const auto& [key, value] : settings)
        text += (text.empty() ? before : between) + key + "=" + value;
    return text;
}

bool has(const std::vector<GivenValue>& settings, const GivenValue& setting) {
    return std::ranges::find(settings, setting) != settings.end();
}

/// The `spp` of a label says nothing if every run ended before: by its budget, or because it had converged.
bool is_spp_reached(const Analysis& analysis, const std::string& label, double spp) {
    return analysis.index.is_external(label) || std::ranges::any_of(analysis.cells, [&](const Cell& cell) {
               return cell.method == label && !cell.checkpoints.empty() && cell.last().passes >= spp;
           });
}

/// The settings of the labels that share the beginning of their names.
using Group = std::map<std::string, std::vector<GivenValue>>;

/// A filter changes the method, so it is shown behind the name even if all rows have it.
std::vector<GivenValue> differing(const Group& group, const std::string& label, bool is_named,
                                  const Analysis& analysis) {
    std::vector<GivenValue> settings = group.at(label);
    std::erase_if(settings, [&](const GivenValue& setting) {
        const auto spp = setting.first == "spp" ? number_from<double>(setting.second) : std::nullopt;
        if (!is_named && setting.first == "filter" && setting.second != no_filter) return false;
        return (spp && !is_spp_reached(analysis, label, *spp)) ||
               std::ranges::all_of(group, [&](const auto& other) { return has(other.second, setting); });
    });
    return settings;
}

using SceneAndLabel = std::pair<std::string, std::string>;

/// The complete runs of one label in one scene.
struct LabelRuns {
    std::string label;
    std::size_t seeds = 0;
    std::uint32_t passes = 0;  ///< the most of any seed
};

/// The runs of each label, by scene and by label without `spp`, in the order of the cells.
std::map<SceneAndLabel, std::vector<LabelRuns>> runs_by_method(const Analysis& analysis) {
    std::map<SceneAndLabel, std::vector<LabelRuns>> methods;
    for (const Cell& cell : analysis.cells) {
        // A command starts anew for each number of samples, so that its labels are runs of their own.
        const bool is_external = analysis.index.is_external(cell.method);
        auto& labels = methods[{cell.scene, is_external ? cell.method : label_without_spp(cell.method)}];
        auto found = std::ranges::find(labels, cell.method, &LabelRuns::label);
        if (found == labels.end()) found = labels.insert(labels.end(), {.label = cell.method});
        ++found->seeds;
        if (!cell.checkpoints.empty()) found->passes = std::max(found->passes, cell.last().passes);
    }
    return methods;
}

}  // namespace

std::map<std::string, std::string> short_names(const Analysis& analysis) {
    const auto& given = analysis.index.given_names;
    std::map<std::pair<bool, std::string>, Group> groups;  // by whether the experiment names it, and the beginning
    for (const TableRow& row : analysis.rows) {
        const MethodLabel label = MethodLabel::parse(row.method);
        const auto name = given.find(row.method);
        const bool is_named = name != given.end();
        groups[{is_named, is_named ? name->second : label.name}][row.method] = label.values;
    }
    std::map<std::string, std::string> names;
    std::map<std::pair<bool, std::string>, int> uses;
    for (const auto& [begin, group] : groups)
        for (const auto& [label, settings] : group) {
            const bool is_named = begin.first;
            const std::vector<GivenValue> shown = differing(group, label, is_named, analysis);
            names[label] = begin.second + (is_named ? joined(shown, ", ", ", ") : joined(shown, " ", " "));
            ++uses[{is_named, names[label]}];
        }
    // Where a given name and another one are equal, the other one has all settings, unless these are that name.
    for (auto& [label, name] : names) {
        const bool is_named = given.contains(label);
        const bool is_taken = is_named ? names.contains(name) : uses.contains({true, name});
        if (is_taken || uses.at({is_named, name}) > 1) name = label;
    }
    return names;
}

Analysis with_short_names(Analysis analysis) {
    const auto names = short_names(analysis);
    const auto rename = [&](std::string& method) {
        if (const auto found = names.find(method); found != names.end()) method = found->second;
    };
    for (const auto& [label, name] : names)
        analysis.labels[name] = label;
    for (TableRow& row : analysis.rows)
        rename(row.method);
    for (Cell& cell : analysis.cells)
        rename(cell.method);
    for (EqualTimeLook& look : analysis.looks)
        rename(look.method);
    // A label without rows could have the short name of another one.
    std::erase_if(analysis.index.methods, [&](const std::string& label) { return names.count(label) == 0; });
    for (auto* methods : {&analysis.index.methods, &analysis.index.externals})
        std::for_each(methods->begin(), methods->end(), rename);
    std::map<std::pair<std::string, std::string>, std::vector<std::uint32_t>> stops;
    for (auto& [of, passes] : analysis.stops) {
        std::string method = of.second;
        rename(method);
        stops[{of.first, method}] = std::move(passes);
    }
    analysis.stops = std::move(stops);
    return analysis;
}

std::string label_without_spp(const std::string& label) {
    MethodLabel parsed = MethodLabel::parse(label);
    std::erase_if(parsed.values, [](const auto& value) { return value.first == "spp"; });
    return parsed.text();
}

Analysis one_label_a_method(const Analysis& analysis) {
    Analysis merged = analysis;
    std::set<SceneAndLabel> dropped;
    for (const auto& [key, labels] : runs_by_method(analysis)) {
        const LabelRuns& longest = *std::ranges::max_element(
            labels, {}, [](const LabelRuns& runs) { return std::pair(runs.seeds, runs.passes); });
        std::vector<std::uint32_t> stops;
        for (const LabelRuns& runs : labels) {
            if (runs.label == longest.label) continue;
            dropped.insert({key.first, runs.label});
            stops.push_back(runs.passes);
        }
        std::ranges::sort(stops);
        if (!stops.empty()) merged.stops[{key.first, longest.label}] = std::move(stops);
    }
    const auto is_dropped = [&](const auto& of) { return dropped.count({of.scene, of.method}) > 0; };
    std::erase_if(merged.cells, is_dropped);
    std::erase_if(merged.rows, is_dropped);
    std::erase_if(merged.looks, is_dropped);
    return merged;
}

}  // namespace gib
