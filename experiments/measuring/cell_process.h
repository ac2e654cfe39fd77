#pragma once
// Measures a cell in a process of its own, so that its peak memory is its own and a crash does not end the run.
//
// The parent starts its own program with the internal subcommand `measure-cell` (child_request.h). The child loads the
// scene and measures the cell. Into the work folder it writes `checkpoint-PASSES.exr` for each checkpoint. To its
// standard output it prints its progress, `PASSES SECONDS`, at most five times a second.

#include "experiments/measuring/measure.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace gib {

struct CellRequest {
    std::string scene_path;
    std::optional<std::pair<int, int>> resolution;
    std::vector<std::string> folders;  ///< folders that are searched for the scene's files
    std::string scene_hash;            ///< hash of the scene that the parent checked; the child accepts no other
    std::string method;                ///< label
    std::uint64_t seed = 1;
    Budget budget;
    int threads = 0;  ///< 0: one per processor
    /// Layers beside the image, for a filter that is a command (CheckpointFilter::layers()); unless the label's filter
    /// is gibench's own.
    bool features = false, variance = false;
    std::string work_folder;
};

/// Runs in the child: reads the request, measures the cell and writes the results. Throws RunError if the scene has
/// changed since the parent checked it.
void measure_cell(const std::string& request_file);

/// Runs in the parent. `observer` receives the child's progress. Throws as result_of_child() does.
Measurement run_cell_process(const CellRequest& request, const PassObserver& observer = {});

/// The path of the image that the child writes for a checkpoint.
std::string checkpoint_image(const std::string& work_folder, std::uint32_t passes);

}  // namespace gib
