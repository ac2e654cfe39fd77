#include "experiments/run/work_list.h"

#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>

namespace gib {

namespace {

/// The samples a pixel of a cell of another renderer; 1 if its command does not take them.
std::uint32_t passes_of(const ExternalMethod& external, const std::optional<int>& sample_count) {
    if (!external.takes("spp")) return 1;
    return external.spp ? *external.spp : static_cast<std::uint32_t>(sample_count.value_or(default_sample_count));
}

}  // namespace

WorkCell work_cell(const RunSetup& setup, std::size_t scene, const MethodLabel& label, std::uint64_t seed) {
    const RunScene& of = setup.scenes[scene];
    const ExternalMethod* external = setup.experiment.external(label);
    CellIdentity identity;
    identity.scene = of.entry.name;
    identity.method = label.text();
    identity.seed = seed;
    identity.scene_hash = of.content_hash;
    identity.spp =
        external ? passes_of(*external, of.sample_count) : last_pass(ConfiguredMethod(label).values, of.sample_count);
    const ExternalMethod* filter = external ? nullptr : setup.experiment.filter_command(label);
    if (external || filter) identity.command = (external ? external : filter)->identity();
    identity.budget = setup.experiment.budget;
    identity.epsilon = setup.experiment.epsilon;
    identity.threads = setup.threads;
    return {.scene = scene,
            .external = external,
            .filter = filter,
            .identity = identity,
            .name = cell_folder_name(identity.scene, identity.method, seed)};
}

std::string WorkCell::text() const {
    return fmt::format("{}, {}, seed {}", identity.scene, identity.method, identity.seed);
}

WorkList::WorkList(const RunSetup& setup, const std::string& only) {
    for (int seed = 1; seed <= setup.experiment.seeds; ++seed)
        for (std::size_t scene = 0; scene < setup.scenes.size(); ++scene)
            for (const MethodLabel& label : setup.experiment.methods) {
                cells_.push_back(work_cell(setup, scene, label, static_cast<std::uint64_t>(seed)));
                cells_.back().is_selected = is_kept(only, setup.experiment, cells_.back().identity.scene, label);
            }
}

void WorkList::keep(const std::map<std::string, Budget>& budgets) {
    std::erase_if(cells_, [&](const WorkCell& cell) { return budgets.count(cell.name) == 0; });
    for (WorkCell& cell : cells_)
        cell.identity.budget = budgets.at(cell.name);
}

void WorkList::select(const RunShare& share) {
    std::size_t place = 0;
    for (WorkCell& cell : cells_)
        cell.is_selected = cell.is_selected && share.has(place++);
}

void WorkList::use(const References& references) {
    for (WorkCell& cell : cells_)
        cell.identity.reference = references.has_failed(cell.scene) ? "" : references.identity(cell.scene);
}

bool WorkList::has(std::size_t scene) const {
    return std::ranges::any_of(cells_, [&](const WorkCell& cell) { return cell.is_selected && cell.scene == scene; });
}

std::vector<const WorkCell*> WorkList::selected() const {
    std::vector<const WorkCell*> cells;
    for (const WorkCell& cell : cells_)
        if (cell.is_selected) cells.push_back(&cell);
    return cells;
}

std::vector<WorkCell> WorkList::with_records(const ResultFolder& folder) const {
    std::vector<WorkCell> cells;
    for (const WorkCell* cell : selected()) {
        WorkCell& found = cells.emplace_back(*cell);
        if (!cell->identity.reference.empty())
            found.record = folder.read_cell(cell->name, cell->identity.key(), &found.damage);
    }
    return cells;
}

std::vector<const WorkCell*> left_of(const std::vector<WorkCell>& cells) {
    std::vector<const WorkCell*> left;
    for (const WorkCell& cell : cells)
        if (!cell.record) left.push_back(&cell);
    return left;
}

std::vector<Cell> complete_cells(const WorkList& list, const ResultFolder& folder) {
    std::vector<Cell> complete;
    for (const WorkCell& cell : list.all())
        if (auto stored = folder.read_cell(cell.name, cell.identity.key())) complete.push_back(std::move(*stored));
    return complete;
}

}  // namespace gib
