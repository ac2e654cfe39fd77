#pragma once
// Measures cells one after another, computes the errors of their images and stores them.

#include "experiments/measuring/cell_process.h"
#include "experiments/results/judgement.h"
#include "experiments/run/work_list.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gib {

class CellRunner {
public:
    CellRunner(const RunSetup& setup, const ResultFolder& folder, RunLog& log)
        : setup_(setup), folder_(folder), log_(log) {}

    /// Measures a cell, unless another process does, or has. A failure is kept in the log and in the cell's folder.
    /// Throws Interrupted.
    void run(const WorkCell& cell, const PassObserver& observer = {});

private:
    void measure(const WorkCell& cell, const PassObserver& observer);
    /// Renders the cell in a process of its own, which leaves its images in the work folder.
    Measurement render(const WorkCell& cell, const std::string& work_folder, const PassObserver& observer) const;
    /// The record of a cell; its errors are computed and its images stored.
    Cell judged(const WorkCell& cell, const Measurement& measured, const std::string& work_folder) const;
    void keep_failure(const std::string& cell, const std::string& message);

    const RunSetup& setup_;
    const ResultFolder& folder_;
    RunLog& log_;
    std::optional<Reference> reference_;  ///< that of the last cell; those of many scenes would not fit in memory
    std::optional<Judgement> judgement_;
    std::string referred_;  ///< identity of `reference_`
};

/// Runs cells in turn, with a line of progress, and begins none when `seconds_left` is given and not above 0. Returns
/// how many it began. Throws Interrupted.
std::size_t run_cells(const std::vector<const WorkCell*>& cells, CellRunner& runner, ProgressLine& progress,
                      const std::function<double()>& seconds_left = {});

}  // namespace gib
