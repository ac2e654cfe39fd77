#pragma once
// What a run has read and checked before it computes anything: the experiment, the facts about its scenes, and what the
// methods leave out in them.
// What a run says while it works: its line of progress, and what has failed.
// The cells of an experiment: their order, what identifies them, and which of them are left to be measured.

#include "common/reader/scene_file.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/plan/run_options.h"
#include "experiments/results/layer.h"
#include "experiments/results/manifest.h"
#include "experiments/results/result_folder.h"
#include "experiments/run/references.h"
#include "experiments/system/progress.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

struct RunScene {
    ExperimentScene entry;
    std::string content_hash;
    std::optional<int> sample_count;  ///< samples a pixel in the file's sampler
    int width = 0, height = 0;        ///< size of its images [pixels]
    std::string povray = "";          ///< scene in POV-Ray's form, if a selected method takes that
};

struct RunSetup {
    Experiment experiment;
    int threads = 1;
    std::string program, command_line;  ///< RunOptions
    std::string build;                  ///< digest of this program
    std::vector<RunScene> scenes = {};  ///< in the experiment's order
    /// What the methods leave out, as ResultIndex has it.
    std::map<std::pair<std::string, std::string>, LeftOut> left_out = {};

    /// Loads a scene again. Only one is in memory at a time. Throws RunError if it was changed since it was checked.
    LoadedScene load(const RunScene& scene) const;
};

/// Loads every scene and plans every method on it. `options` are those beside the experiment's file. Nothing is written.
/// Throws InputError.
RunSetup checked_setup(Experiment experiment, const RunOptions& options);

/// Whether `--only TEXT` keeps the cells of a label on a scene.
inline bool is_kept(const std::string& only, const std::string& scene, const std::string& label) {
    return scene.find(only) != std::string::npos || label.find(only) != std::string::npos;
}

struct RunLog {
    struct Failure {
        std::string of;  ///< cell or reference
        std::string message;

        std::string text() const { return of + ": " + message; }
    };

    ProgressLine progress;
    std::vector<Failure> failures;

    void fail(const std::string& of, const std::string& message) {
        failures.push_back({of, message});
        progress.message("failed: " + failures.back().text());
    }
    /// Says all failures again at the end of a run, and returns its exit code.
    int exit_code() const;
};

struct WorkCell {
    std::size_t scene;               ///< place in RunSetup::scenes
    const ExternalMethod* external;  ///< null: a method of gibench
    const ExternalMethod* filter;    ///< command that filters its images; null: none does
    CellIdentity identity;           ///< without the reference until WorkList::use()
    std::string name;                ///< name of its folder
    bool is_selected = true;         ///< whether this run is to measure it

    /// Whether a command makes its final image, which then has no components.
    bool has_command() const { return external || filter; }
    std::string text() const;  ///< scene, label and seed for messages
};

/// A cell as it stands in a result folder.
struct CellState {
    const WorkCell* cell;
    std::optional<Cell> record;  ///< empty: it is not complete
    std::string damage;          ///< message about a record that cannot be read
};
/// The cells that are not complete.
std::vector<const WorkCell*> left_of(const std::vector<CellState>& states);

/// The cell of a label; all others of a list are made like it.
WorkCell work_cell(const RunSetup& setup, std::size_t scene, const MethodLabel& label, std::uint64_t seed);

class WorkList {
public:
    /// All cells, of which `only` selects some. Seeds are outermost, so that costs are known after the first seed and a
    /// machine that slows down treats all methods alike.
    WorkList(const RunSetup& setup, const std::string& only);

    /// Keeps only the cells of these names, each with a budget of its own instead of the experiment's.
    void keep(const std::map<std::string, Budget>& budgets);
    /// Of the selected cells, every share.count-th stays selected.
    void select(const RunShare& share);
    /// The references with which cells are judged; without one, a cell cannot be complete.
    void use(const References& references);

    /// Whether a cell of the scene is selected.
    bool has(std::size_t scene) const;
    const std::vector<WorkCell>& all() const { return cells_; }
    std::vector<const WorkCell*> selected() const;
    /// The selected cells as they stand in the folder.
    std::vector<CellState> states(const ResultFolder& folder) const;

private:
    std::vector<WorkCell> cells_;
};

/// All complete cells, selected or not.
std::vector<ManifestCell> manifest_cells(const WorkList& list, const ResultFolder& folder);

}  // namespace gib
