#pragma once
// Runs an experiment (`gibench run`): references, then cells, then tables and report.

#include "common/reader/scene_file.h"
#include "experiments/measuring/cell_process.h"
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
    /// Reads and checks everything, then locks the result folder until this object is destroyed. Throws InputError.
    explicit ExperimentRun(const RunOptions& options);

    /// Brings every selected scene's reference to its goal, and measures every selected cell that is not complete. A
    /// scene whose reference cannot be made fails with all its cells. Returns false if the user interrupted it.
    bool measure();
    /// Writes tables, images and report of all complete cells of the experiment. Returns the report's path.
    std::string write_results();

    /// All complete cells, seeds outermost, including those that earlier runs completed.
    std::vector<ManifestCell> complete_cells();

    const ResultFolder& folder() const { return folder_; }
    /// A line for each reference and each cell that failed.
    const std::vector<std::string>& failures() const { return failures_; }

private:
    struct SceneState {
        ExperimentScene entry;
        std::string content_hash;
        std::optional<int> sample_count;  ///< of the file's sampler
        int width = 0, height = 0;        ///< of its images [pixels]
        std::string povray = "";          ///< in POV-Ray's form, if a method takes that
        std::string reference = "";       ///< identity; empty: there is none
        std::vector<std::string> notes = {};
        bool failed = false;  ///< its reference could not be made
    };
    struct PlannedCell {
        SceneState* scene;
        const MethodLabel* label;
        const ExternalMethod* external;  ///< null: a method of gibench
        CellIdentity identity;
        std::string name;  ///< of its folder
    };

    bool selected(const std::string& scene, const MethodLabel& label) const;
    bool selected(const SceneState& scene) const;
    /// Deletes the records of the selected cells at once, so that a run which continues after an interruption does
    /// not take them for fresh ones.
    void forget_cells();
    void make_references();
    void run_cells();
    void make_reference_of(SceneState& scene);
    /// Takes the image that the experiment gives as the scene's reference.
    void take_given_reference(SceneState& scene);
    /// Takes the reference with which the run that is repeated was measured. Returns false if no run is repeated or
    /// if that reference is not intact.
    bool take_reference_of(SceneState& scene);
    /// All cells of the experiment, seeds outermost, so that costs are known after the first seed and a machine that
    /// slows down treats all methods alike.
    std::vector<PlannedCell> cells();
    std::vector<const PlannedCell*> cells_to_do(const std::vector<PlannedCell>& all);
    void run_cell(const PlannedCell& cell, const class Judgement& judgement, const PassObserver& observer);
    /// Renders a cell in a process of its own, which leaves its images in the work folder.
    CellTiming render_cell(const PlannedCell& cell, const std::string& work_folder, const PassObserver& observer);
    void fail(const std::string& what);
    ResultIndex index();
    /// Loads a scene. Only one is in memory at a time, while its methods are planned and its reference is made; cells
    /// load it in their own processes.
    LoadedScene load(const ExperimentScene& entry) const;
    void plan_methods(const LoadedScene& scene);
    /// The scene in POV-Ray's form; empty if no selected method takes it. Throws InputError for what it cannot express.
    std::string povray_form(const ExperimentScene& entry, const LoadedScene& loaded) const;
    void link_images(const ResultIndex& index);

    RunOptions options_;
    Experiment experiment_;
    int threads_;
    ResultFolder folder_;
    std::optional<FileLock> lock_;  ///< of the folder
    std::vector<SceneState> scenes_;
    std::map<std::pair<std::string, std::string>, std::string> effects_missing_, components_missing_;
    std::string build_;
    ProgressLine progress_;
    std::vector<std::string> failures_;
};

/// The notes about references in a folder's index, by the references' identities; empty if no index can be read.
std::map<std::string, std::vector<std::string>> stored_notes(const ResultFolder& folder);

/// Makes `to` a hard link to the file `from`, or a copy if the file system has no hard links; an existing `to` is
/// replaced at once. Throws RunError.
void link_file(const std::string& from, const std::string& to);

}  // namespace gib
