#include "experiments/analysis/short_names.h"

#include "common/core/number_text.h"
#include "experiments/plan/filter_label.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

namespace gib {

namespace {

using Setting = std::pair<std::string, std::string>;

std::string joined(const std::vector<Setting>& settings, const std::string& before, const std::string& between) {
    std::string text;
    for (const auto& [key, value] : settings)
        text += (text.empty() ? before : between) + key + "=" + value;
    return text;
}

bool has(const std::vector<Setting>& settings, const Setting& setting) {
    return std::ranges::find(settings, setting) != settings.end();
}

/// The `spp` of a label says nothing if every run ended before: by its budget, or because it had converged.
bool is_spp_reached(const Analysis& analysis, const std::string& label, double spp) {
    return analysis.index.is_external(label) || std::ranges::any_of(analysis.cells, [&](const Cell& cell) {
               return cell.method == label && !cell.checkpoints.empty() && cell.last().passes >= spp;
           });
}

/// The settings of the labels that share the beginning of their names.
using Group = std::map<std::string, std::vector<Setting>>;

std::vector<Setting> differing(const Group& group, const std::string& label, const Analysis& analysis) {
    std::vector<Setting> settings = group.at(label);
    std::erase_if(settings, [&](const Setting& setting) {
        const auto spp = setting.first == "spp" ? number_from<double>(setting.second) : std::nullopt;
        if (setting.first == "filter" && setting.second != no_filter) return false;
        return (spp && !is_spp_reached(analysis, label, *spp)) ||
               std::ranges::all_of(group, [&](const auto& other) { return has(other.second, setting); });
    });
    return settings;
}

}  // namespace

std::map<std::string, std::string> short_names(const Analysis& analysis) {
    std::map<std::string, Group> groups;  // by the beginning of the name
    const auto given = [&](const std::string& label) {
        const auto found = analysis.index.given_names.find(label);
        return found == analysis.index.given_names.end() ? std::string() : found->second;
    };
    for (const TableRow& row : analysis.rows) {
        const MethodLabel label = MethodLabel::parse(row.method);
        groups[given(row.method).empty() ? label.name : given(row.method)][row.method] = label.values;
    }
    std::map<std::string, std::string> names;
    std::map<std::string, int> uses;
    for (const auto& [begin, group] : groups)
        for (const auto& [label, settings] : group) {
            const std::vector<Setting> shown = differing(group, label, analysis);
            names[label] = begin + (given(label).empty() ? joined(shown, " ", " ") : joined(shown, ", ", ", "));
            ++uses[names[label]];
        }
    for (auto& [label, name] : names)
        if (uses[name] > 1) name = label;
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

}  // namespace gib
