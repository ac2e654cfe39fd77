#pragma once
// Measures a cell with the command of another renderer, or filters its images by a command: hands over the files, runs the
// command, and reads and checks its image.

#include "experiments/measuring/cell_process.h"
#include "experiments/plan/external_method.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gib {

/// The cell whose image a command makes or filters.
struct CommandCell {
    const ExternalMethod& method;
    std::string folder;  ///< folder in which the command runs: that of the experiment file
    int width = 0, height = 0;
    int threads = 1;
    std::string cell_folder;  ///< keeps what the command printed: stdout.txt and stderr.txt
    std::string work_folder;
};

/// The input of another renderer.
struct RendererInput {
    std::string scene_file;  ///< the scene's own file
    std::string scene_text;  ///< the scene in the form that the command takes; empty: the file as it is
    std::uint64_t seed = 1;
    std::uint32_t spp = 1;          ///< samples a pixel, if the command takes {spp}
    std::optional<double> seconds;  ///< value of {seconds}
};

/// Runs the command and leaves its image in the work folder as the image of one checkpoint (checkpoint_image()), whose
/// only layer is R,G,B. Charged is the wall-clock time of the whole command. Throws RunError, with the last line of its
/// standard error, if the command fails, is killed or takes too long, and if its image is missing, has another size or has
/// values that are not finite; Interrupted on Ctrl-C.
CellTiming run_external_cell(const std::string& program, const CommandCell& cell, const RendererInput& input);

/// Puts the command's image in the place of that of each checkpoint (checkpoint_image()), whose further layers it may read. It is
/// run once for each, and the checkpoint is charged with its wall-clock time. Throws like run_external_cell().
void filter_checkpoints(const std::string& program, const CommandCell& cell, Measurement& measured);

}  // namespace gib
