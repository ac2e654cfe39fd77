#pragma once
// Runs an experiment (`gibench run`): references, then cells, then tables and report.

#include "common/reader/scene_file.h"
#include "experiments/measuring/cell_process.h"
#include "experiments/measuring/reference.h"
#include "experiments/plan/run_options.h"
#include "experiments/results/manifest.h"
#include "experiments/results/result_folder.h"
#include "experiments/run/run_plan.h"
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
    /// Where others work in the folder too (RunOptions::shared), it is not locked, and no unfinished file is removed.
    explicit ExperimentRun(const RunOptions& options);
    /// One of several processes of a run: takes from the plan what the first one has read and checked, and loads no scene.
    ExperimentRun(const RunOptions& options, const RunPlan& plan);

    /// Brings every selected scene's reference to its goal, and measures every selected cell that is not complete. A
    /// scene whose reference cannot be made fails with all its cells. Returns false if the user interrupted it.
    bool measure();
    /// Writes tables, images and report of all complete cells of the experiment. Returns the report's path.
    std::string write_results();

    /// All complete cells, seeds outermost, including those that earlier runs completed.
    std::vector<ManifestCell> complete_cells();

    // A run of several processes (shared_run.cpp).

    /// The plan for other processes, without their tasks.
    RunPlan plan() const;
    /// The selected cells, complete or not.
    std::vector<CellState> states();
    /// Deletes the records of the selected cells at once, so that a run which continues after an interruption does
    /// not take them for fresh ones.
    void forget_cells();
    /// Measures those of the cells that are not complete and that no other process measures. Returns false if the user
    /// interrupted it.
    bool measure_cells(const std::vector<CellPlace>& places);
    /// Brings every selected scene's reference on its way, by at most so much work of this process for each
    /// (MadeBatch::work). Returns the batches that others have to make before it can go on.
    std::vector<PlannedBatch> advance_references(double most_own_work);
    /// Makes those of the batches that are not there. Returns false if the user interrupted it.
    bool make_batches(const std::vector<PlannedBatch>& batches);
    /// Writes the index, with the notes about references.
    void write_index() { folder_.write_index(index()); }

    const ResultFolder& folder() const { return folder_; }
    /// A line for each reference and each cell that failed.
    const std::vector<std::string>& failures() const { return failures_; }

private:
    struct SceneState {
        ExperimentScene entry;
        std::string content_hash;
        std::optional<int> sample_count;  ///< samples a pixel in the file's sampler
        int width = 0, height = 0;        ///< size of its images [pixels]
        std::string povray = "";          ///< scene in POV-Ray's form, if a method takes that
        std::string reference = "";       ///< identity; empty: there is none
        std::vector<std::string> notes = {};
        bool failed = false;                       ///< its reference could not be made
        std::vector<ReferenceBatch> missing = {};  ///< batches of its reference, to be made by others
    };
    struct PlannedCell {
        SceneState* scene;
        const MethodLabel* label;
        const ExternalMethod* external;  ///< null: a method of gibench
        CellPlace place;
        CellIdentity identity;
        std::string name;  ///< name of its folder
    };

    void require_a_cell() const;
    /// Makes and, unless it is shared, locks the result folder.
    void prepare_folder();
    /// Takes over the references in the result folder, with their notes.
    void take_stored_references();
    bool selected(const std::string& scene, const MethodLabel& label) const;
    bool selected(const SceneState& scene) const;
    void make_references();
    void run_cells(const std::vector<const PlannedCell*>& to_do);
    /// Runs a cell and keeps its failure. `reference` is that of the cell's scene.
    void try_cell(const PlannedCell& cell, std::optional<Reference>& reference, const SceneState*& referred,
                  const PassObserver& observer);
    void make_reference_of(SceneState& scene);
    /// Takes the image that the experiment gives as the scene's reference.
    void take_given_reference(SceneState& scene);
    /// Takes the reference with which the run that is repeated was measured. Returns false if no run is repeated or
    /// if that reference is not intact.
    bool take_reference_of(SceneState& scene);
    /// The scene, method and goal of a reference that gibench makes.
    ReferenceWork reference_work(const SceneState& scene, const LoadedScene& loaded) const;
    /// A cell; empty if the run that is repeated does not have it.
    std::optional<PlannedCell> cell_at(const CellPlace& place);
    /// All cells of the experiment, seeds outermost, so that costs are known after the first seed and a machine that
    /// slows down treats all methods alike.
    std::vector<PlannedCell> cells();
    std::vector<const PlannedCell*> cells_to_do(const std::vector<PlannedCell>& all);
    void run_cell(const PlannedCell& cell, const class Judgement& judgement, const PassObserver& observer);
    /// Renders a cell in a process of its own, which leaves its images in the work folder.
    CellTiming render_cell(const PlannedCell& cell, const std::string& work_folder, const PassObserver& observer);
    void fail(const std::string& what);
    /// Leaves the message of a failed cell in its folder.
    void keep_failure(const std::string& cell, const std::string& what);
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
    std::optional<FileLock> lock_;  ///< lock of the folder
    std::vector<SceneState> scenes_;
    std::map<std::pair<std::string, std::string>, std::string> effects_missing_, components_missing_;
    std::string build_;
    std::optional<double> most_own_work_;  ///< ReferenceWork::most_own_work
    ProgressLine progress_;
    std::vector<std::string> failures_;
};

/// The notes about references in a folder's index, by the references' identities; empty if no index can be read.
std::map<std::string, std::vector<std::string>> stored_notes(const ResultFolder& folder);

/// Makes `to` a hard link to the file `from`, or a copy if the file system has no hard links; an existing `to` is
/// replaced at once. Throws RunError.
void link_file(const std::string& from, const std::string& to);

}  // namespace gib
