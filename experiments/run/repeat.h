#pragma once
// `gibench run --repeat RESULT_DIR`: every complete cell of a run once more, with exactly the passes that it made and
// as many threads, into a result folder of its own; the images have to be the same bit for bit.

#include <iosfwd>
#include <optional>
#include <string>

namespace gib {

struct RepeatOptions {
    std::string folder;              ///< with the results to repeat; only read
    std::optional<std::string> out;  ///< else folder + "-repeat"
    std::string program;             ///< that measures a cell
    std::string command_line;        ///< as typed, for the manifest
};

/// One line a cell to `out`. Exit code: 0 all are identical, 1 one is not or could not be done, 130 interrupted. Throws
/// InputError, before anything is computed, if the manifest cannot be repeated or a scene was changed; another commit,
/// compiler, library or processor is a warning.
int repeat_run(const RepeatOptions& options, std::ostream& out);

}  // namespace gib
