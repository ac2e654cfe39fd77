#pragma once
// Measures a cell with the command of another renderer, or filters its images by a command: hands over the files, runs
// the command under the clock, and reads and checks its image.
// `gibench run` starts the program with the internal subcommand
// `measure-command request.json`; that process forks a shell with the command, waits, and leaves seconds and memory in
// result.json. It is a process of its own because the peak memory of a process that a large one starts includes that of
// its parent (ru_maxrss is kept across exec), while this one is small.

#include "experiments/measuring/cell_process.h"
#include "experiments/plan/external_method.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gib {

struct CommandRequest {
    std::string command;      ///< text for /bin/sh
    std::string folder;       ///< folder in which it runs
    double timeout = 0;       ///< wall-clock time after which it is killed [s]
    std::string cell_folder;  ///< receives its standard output and error: stdout.txt and stderr.txt
    std::string work_folder;  ///< folder for request.json and result.json
};

struct CommandResult {
    double seconds = 0;       ///< wall-clock time from the start of the shell to its end [s]
    double peak_rss_mib = 0;  ///< largest resident set among the shell and the processes that it waited for [MiB]
    bool timed_out = false;
    int exit_code = 0;
    int signal = 0;  ///< signal that ended it; 0: none
};

/// Runs in the process of `measure-command`. When the command has ended, all processes that it has started are killed,
/// also those in sessions of their own.
void measure_command(const std::string& request_file);

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
    std::uint64_t seed = 1;
    std::uint32_t spp = 1;          ///< samples a pixel, if the command takes {spp}
    std::optional<double> seconds;  ///< value of {seconds}
};

/// Runs the command and leaves its image in the work folder as the image of one checkpoint (checkpoint_image()), whose
/// only layer is R,G,B. Charged is the wall-clock time of the whole command. Throws RunError, with the last line of its
/// standard error, if the command fails, is killed or takes too long, and if its image is missing, has another size or
/// has values that are not finite; Interrupted on Ctrl-C.
Measurement run_external_cell(const CommandCell& cell, const RendererInput& input);

/// Puts the command's image in the place of that of each checkpoint (checkpoint_image()), whose further layers it may
/// read. It is run once for each, and the checkpoint is charged with its wall-clock time. Throws like
/// run_external_cell().
void filter_checkpoints(const CommandCell& cell, Measurement& measured);

}  // namespace gib
