#pragma once
// Runs a filter that is a command on the images of a cell.

#include "experiments/measuring/cell_process.h"
#include "experiments/plan/external_method.h"

#include <string>

namespace gib {

struct FilteredCell {
    const ExternalMethod& filter;
    std::string folder;  ///< folder in which the command runs: that of the experiment file
    int threads = 1;
    std::string cell_folder, work_folder;
};

/// Puts the command's image in the place of that of each checkpoint (checkpoint_image()), whose further layers it may read. It is
/// run once for each, and the checkpoint is charged with its wall-clock time. Throws like run_image_command().
void filter_checkpoints(const std::string& program, const FilteredCell& cell, Measurement& measured);

}  // namespace gib
