#include "experiments/analysis/same_method.h"

#include "methods/parameters.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace gib {

namespace {

using SceneAndLabel = std::pair<std::string, std::string>;

/// The complete runs of one label in one scene.
struct LabelRuns {
    std::string label;
    std::size_t seeds = 0;
    std::uint32_t passes = 0;  ///< the most of any seed

    bool operator<(const LabelRuns& other) const {
        return std::tuple(seeds, passes) < std::tuple(other.seeds, other.passes);
    }
};

/// The runs of each label, by scene and by label without `spp`, in the order of the cells.
std::map<SceneAndLabel, std::vector<LabelRuns>> runs_by_method(const Analysis& analysis) {
    std::map<SceneAndLabel, std::vector<LabelRuns>> methods;
    for (const Cell& cell : analysis.cells) {
        // A command starts anew for each number of samples, so that its labels are runs of their own.
        const bool is_external = analysis.index.is_external(cell.method);
        auto& labels = methods[{cell.scene, is_external ? cell.method : label_without_spp(cell.method)}];
        auto found = std::ranges::find_if(labels, [&](const auto& l) { return l.label == cell.method; });
        if (found == labels.end()) found = labels.insert(labels.end(), {.label = cell.method});
        ++found->seeds;
        if (!cell.checkpoints.empty()) found->passes = std::max(found->passes, cell.last().passes);
    }
    return methods;
}

}  // namespace

std::string label_without_spp(const std::string& label) {
    MethodLabel parsed = MethodLabel::parse(label);
    std::erase_if(parsed.values, [](const auto& value) { return value.first == "spp"; });
    return parsed.text();
}

Analysis one_label_a_method(const Analysis& analysis) {
    Analysis merged = analysis;
    std::set<SceneAndLabel> dropped;
    for (const auto& [key, labels] : runs_by_method(analysis)) {
        const LabelRuns& longest = *std::ranges::max_element(labels);
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
