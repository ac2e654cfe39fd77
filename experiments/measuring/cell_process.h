#pragma once
// A timed cell in its own process, so that its peak memory is its own and its death ends nothing else.
//
// The parent writes request.json into the cell's work folder and starts the program with the internal subcommand
// `measure-cell request.json`. The child loads the scene, measures, and leaves there `checkpoint-PASSES.exr` for each
// checkpoint and, at the end, timing.json (whole or not at all). On its standard output it says `PASSES SECONDS` now
// and then.

#include "experiments/measuring/measure.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace gib {

struct CellRequest {
    std::string scene_path;
    std::optional<std::pair<int, int>> resolution;
    std::string scene_hash;  ///< the scene must still be the one that the parent checked
    std::string method;      ///< label
    std::uint64_t seed = 1;
    Budget budget;
    int threads = 0;  ///< 0: one per processor
    std::string work_folder;
};

struct CellTiming {
    double load_seconds = 0;
    Measurement measurement;
};

/// The child's side: reads a request, measures, writes the results.
void measure_cell(const std::string& request_file);

/// The parent's side: runs `program` and waits. Throws RunError with the child's message if it fails, Interrupted (and
/// stops the child) on Ctrl-C.
CellTiming run_cell_process(const std::string& program, const CellRequest& request, const PassObserver& observer = {});

/// The image of a checkpoint, left by the child.
std::string checkpoint_image(const std::string& work_folder, std::uint32_t passes);

}  // namespace gib
