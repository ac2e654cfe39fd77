#pragma once
// Runs a command that writes an image, and checks that image.

#include "common/images/image.h"
#include "experiments/external/command_process.h"

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

}  // namespace gib
