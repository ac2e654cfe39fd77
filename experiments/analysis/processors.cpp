#include "experiments/analysis/processors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>

namespace gib {

std::string processors_of(const std::vector<const Cell*>& cells) {
    std::set<std::string> names;
    for (const Cell* cell : cells)
        if (!cell->cpu.empty()) names.insert(cell->cpu);
    return fmt::format("{}", fmt::join(names, ";"));
}

std::string unlike_processors(const std::vector<Cell>& cells, const std::string& scene) {
    std::map<std::string, std::set<std::string>> methods;  // by the processor's name
    for (const Cell& cell : cells)
        if (cell.scene == scene && !cell.cpu.empty()) methods[cell.cpu].insert(cell.method);
    if (methods.size() < 2) return "";
    std::string text = "the cells were measured on unlike processors, so that their seconds do not compare";
    for (const auto& [cpu, labels] : methods)
        text += fmt::format("; on '{}': {}", cpu, fmt::join(labels, ", "));
    return text;
}

}  // namespace gib
