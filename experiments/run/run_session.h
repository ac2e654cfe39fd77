#pragma once
// The parts of a run, which are opened in this order. Each kind of run has its own loop over them: a local one, a share
// of a cluster, a repetition, the rounds of a tuning.
//
// The names of a cell, which is one scene with one method and one seed:
//   CellIdentity  everything that decides its result, and its key (result_folder.h)
//   WorkCell      its place in the list of cells, and its record if it is complete (work_list.h)
//   CellRequest   the files and settings that its process receives (cell_process.h)
//   Cell          the stored record: what measure() found, with errors against the reference (result_folder.h)

#include "experiments/run/cell_runner.h"
#include "experiments/run/references.h"
#include "experiments/run/run_setup.h"
#include "experiments/run/work_list.h"
#include "experiments/system/file_lock.h"

#include <optional>
#include <string>

namespace gib {

/// Whether a process works in a result folder alone, and so locks it and removes what a killed one left, or beside
/// others.
enum class FolderUse { alone, shared };

struct RunSession {
    /// Throws InputError if nothing can be written in the folder, or if another process works there and this one wants
    /// to be alone. Shares may still begin beside it; it leaves out the cells that they have taken.
    RunSession(RunSetup checked, const RunOptions& options, FolderUse use);
    RunSession(const RunSession&) = delete;
    RunSession& operator=(const RunSession&) = delete;

    /// Brings the references of all scenes with selected cells to their goals. Throws Interrupted.
    void make_references();
    /// Deletes the records of the selected cells at once, so that a run which continues after an interruption does not
    /// take them for fresh ones.
    void forget_cells();

    /// Says how many of the selected cells are not complete; empty: all are.
    std::string what_is_left() const;

    /// Writes the index, without which there are no tables.
    void write_index();
    /// Writes tables, images and report of all complete cells. Returns the report's path. Sets `verdict`.
    std::string write_results();

    RunLog log;
    RunSetup setup;
    ResultFolder folder;
    std::optional<FileLock> lock;
    References references;
    WorkList list;
    CellRunner runner;
    std::string verdict = {};  ///< the verdict for a terminal
};

}  // namespace gib
