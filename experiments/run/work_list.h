#pragma once
// The cells of an experiment: their order, what identifies them, and which of them are left to be measured.

#include "experiments/results/manifest.h"
#include "experiments/results/result_folder.h"
#include "experiments/run/references.h"
#include "experiments/run/run_setup.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

struct WorkCell {
    std::size_t scene;                ///< place in RunSetup::scenes
    const ExternalMethod* external;   ///< null: a method of gibench
    const ExternalMethod* filter;     ///< command that filters its images; null: none does
    CellIdentity identity;            ///< without the reference until WorkList::use()
    std::string name;                 ///< name of its folder
    bool is_selected = true;          ///< whether this run is to measure it
    std::optional<Cell> record = {};  ///< of WorkList::with_records(); empty: the cell is not complete
    std::string damage = {};          ///< message about a record that cannot be read

    /// Whether a command makes its final image, which then has no components.
    bool has_command() const { return external || filter; }
    std::string text() const;  ///< scene, label and seed for messages
};

/// The cells without a record.
std::vector<const WorkCell*> left_of(const std::vector<WorkCell>& cells);

/// The cell of a label. WorkList makes its cells with this function.
WorkCell work_cell(const RunSetup& setup, std::size_t scene, const MethodLabel& label, std::uint64_t seed);

class WorkList {
public:
    /// All cells, or those that `only` selects. Seeds are outermost, so that costs are known after the first seed and a
    /// machine that slows down treats all methods alike.
    WorkList(const RunSetup& setup, const std::string& only);

    /// Keeps only the cells of these names, each with a budget of its own instead of the experiment's.
    void keep(const std::map<std::string, Budget>& budgets);
    /// Keeps the selection of the cells of this share alone.
    void select(const RunShare& share);
    /// The references for the errors of cells; without one, a cell cannot be complete.
    void use(const References& references);

    /// Whether a cell of the scene is selected.
    bool has(std::size_t scene) const;
    const std::vector<WorkCell>& all() const { return cells_; }
    std::vector<const WorkCell*> selected() const;
    /// The selected cells with what the folder has of them.
    std::vector<WorkCell> with_records(const ResultFolder& folder) const;

private:
    std::vector<WorkCell> cells_;
};

/// The records of all complete cells, selected or not.
std::vector<Cell> complete_cells(const WorkList& list, const ResultFolder& folder);

}  // namespace gib
