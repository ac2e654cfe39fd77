#pragma once
// The steps of `gibench run`, and what they share.

#include "common/reader/scene_file.h"
#include "experiments/plan/run_options.h"
#include "experiments/results/manifest.h"
#include "experiments/results/result_folder.h"
#include "experiments/system/file_lock.h"
#include "experiments/system/progress.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gib {

class ExperimentRun {
public:
    /// Reads and checks everything, then takes the folder for itself until it is destroyed. Throws InputError.
    explicit ExperimentRun(const RunOptions& options);

    /// Brings every selected scene's reference to its goal, and measures every selected cell that is not complete. A
    /// scene whose reference cannot be made fails with all its cells. False: interrupted by the user.
    bool measure();
    /// Tables, images and report from all complete cells of the experiment. Returns the report's path.
    std::string write_results();

    /// In the order of the tables' seeds; with those that were complete before.
    std::vector<ManifestCell> complete_cells();

    const ResultFolder& folder() const { return folder_; }
    /// What failed, one line each.
    const std::vector<std::string>& failures() const { return failures_; }

private:
    struct SceneState {
        ExperimentScene entry;
        LoadedScene loaded;
        std::string reference;  ///< identity; empty: none
        std::vector<std::string> notes;
        bool failed = false;  ///< its reference could not be made
    };
    struct PlannedCell {
        SceneState* scene;
        const MethodLabel* label;
        CellIdentity identity;
        std::string name;  ///< of its folder
    };

    bool selected(const SceneState& scene, const MethodLabel& label) const;
    bool selected(const SceneState& scene) const;
    /// From here on the old ones are no results: who goes on after an interruption must not take them for fresh ones.
    void forget_cells();
    void make_references();
    void run_cells();
    void make_reference_of(SceneState& scene);
    /// Takes the reference that a run to repeat was measured with, if it is intact.
    bool take_reference_of(SceneState& scene);
    /// All cells of the experiment, seeds outermost: costs are known after the first seed, and a machine that slows
    /// down treats all methods alike.
    std::vector<PlannedCell> cells();
    std::vector<const PlannedCell*> cells_to_do(const std::vector<PlannedCell>& all);
    void run_cell(const PlannedCell& cell, const class Judgement& judgement, const PassObserver& observer);
    void fail(const std::string& what);
    ResultIndex index();
    void plan_methods();
    void link_images(const ResultIndex& index);

    RunOptions options_;
    Experiment experiment_;
    int threads_;
    ResultFolder folder_;
    std::optional<FileLock> lock_;  ///< of the folder
    std::vector<SceneState> scenes_;
    std::map<std::pair<std::string, std::string>, std::string> effects_missing_;
    std::string build_;
    ProgressLine progress_;
    std::vector<std::string> failures_;
};

/// A second name for a file, or a copy where the file system has none; replaces `to` at once.
void link_file(const std::string& from, const std::string& to);

}  // namespace gib
