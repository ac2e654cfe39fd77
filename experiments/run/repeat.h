#pragma once
// Repeats a run (`gibench run --repeat RESULT_DIR`): renders every complete cell again, with exactly as many passes
// and threads, into another result folder. The images have to be identical bit for bit.

#include <iosfwd>
#include <optional>
#include <string>

namespace gib {

struct RepeatOptions {
    std::string folder;              ///< with the results to repeat; it is only read
    std::optional<std::string> out;  ///< default: folder + "-repeat"
    std::string program;             ///< path of gibench, which measures the cells
    std::string command_line;        ///< as typed, for the manifest
};

/// Repeats the run and prints a line for each cell to `out`. Returns the exit code: 0 if all are identical, 1
/// if one is not or could not be rendered, 130 if interrupted. Throws InputError, before anything is computed,
/// if the manifest cannot be repeated or a scene was changed. Another commit, compiler, library or processor
/// only gives a warning.
int repeat_run(const RepeatOptions& options, std::ostream& out);

}  // namespace gib
