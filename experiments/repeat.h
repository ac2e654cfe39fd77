#pragma once
// `gibench run --repeat RESULT_DIR`: every complete cell of a run once more, with exactly the passes that it made and
// as many threads, into a result folder of its own; the images have to be the same bit for bit.

#include "experiments/experiment_file.h"
#include "experiments/result_folder.h"

#include <cstdint>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>

namespace gib {

/// What a run does instead of what its experiment file says.
struct RepeatPlan {
    Experiment experiment;
    ResultFolder original;
    std::map<std::string, std::uint32_t> passes;      ///< by the folder name of a complete cell
    std::map<std::string, std::string> scene_hashes;  ///< by name, of the scenes with complete cells
    std::map<std::string, std::string> references;    ///< identities by the scene's name

    bool has_cells_of(const std::string& scene, const std::string& method) const;
    std::string reference_of(const std::string& scene) const;
    /// Throws InputError, with its file, if the scene is not what it was.
    void check_scene(const ExperimentScene& scene, const std::string& content_hash) const;
};

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
