#pragma once
// Measures a cell with the command of another renderer, or filters its images by a command: hands over the files, runs the
// command, and reads and checks its image.

#include "common/images/image.h"
#include "experiments/external/command_process.h"
#include "experiments/measuring/cell_process.h"
#include "experiments/plan/external_method.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gib {

/// The input of an image's command.
struct ImageCommand {
    std::string name;     ///< in messages, such as "its command"
    std::string command;  ///< text for /bin/sh
    std::string out;      ///< the image that it is to write
    std::string folder;   ///< folder in which it runs
    double timeout = 0;   ///< wall-clock time after which it is killed [s]
    int width = 0, height = 0;
    std::string cell_folder;  ///< keeps what it prints: stdout.txt and stderr.txt
    std::string work_folder;
};

struct CommandImage {
    Image image;
    CommandResult cost;
};

/// Throws RunError, with the last line of its standard error, if the command fails, is killed or takes too long, and if its
/// image is missing, has another size or has values that are not finite; Interrupted on Ctrl-C.
CommandImage run_image_command(const std::string& program, const ImageCommand& command);

struct ExternalCell {
    const ExternalMethod& method;
    std::string scene_file;  ///< the scene's own file
    std::string scene_text;  ///< the scene in the form that the command takes; empty: the file as it is
    std::string folder;      ///< folder in which the command runs: that of the experiment file
    int width = 0, height = 0;
    std::uint64_t seed = 1;
    std::uint32_t spp = 1;          ///< samples a pixel, if the command takes {spp}
    std::optional<double> seconds;  ///< value of {seconds}
    int threads = 1;
    std::string cell_folder;  ///< keeps what the command printed: stdout.txt and stderr.txt
    std::string work_folder;
};

/// Runs the command and leaves its image in the work folder as the image of one checkpoint (checkpoint_image()), whose
/// only layer is R,G,B. Charged is the wall-clock time of the whole command. Throws RunError, with the last line of its
/// standard error, if the command fails, is killed or takes too long, and if its image is missing, has another size or has
/// values that are not finite; Interrupted on Ctrl-C.
CellTiming run_external_cell(const std::string& program, const ExternalCell& cell);

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
