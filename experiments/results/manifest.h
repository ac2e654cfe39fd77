#pragma once
// Writes and reads manifest.json, which holds everything that a result depends on and that its tables do not say.
// `gibench run --repeat` reads it.

#include "experiments/results/quantities.h"
#include "experiments/results/result_folder.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// The facts about a run that its index does not hold.
struct ManifestRun {
    std::string command_line;     ///< as it was typed
    std::string experiment_file;  ///< its path, as it was typed
    std::optional<std::pair<int, int>> resolution;
    std::vector<Cell> cells;
    std::map<std::string, Components> unjudged = {};  ///< by scene: of quantities_of()
};

std::string manifest_text(const ResultIndex& index, const ManifestRun& run);

/// The content of a manifest that was read back.
struct Manifest {
    struct Scene {
        std::string name, file, content_hash, reference, reference_method;
        Quantities quantities = {};  ///< empty in manifests of older versions
    };
    std::string experiment_file, working_folder, experiment_text;
    int threads = 0, seeds = 1;
    std::optional<double> epsilon;  ///< ResultIndex::epsilon
    std::vector<Scene> scenes;
    /// Complete cells as they can be repeated: with exactly as many passes, whatever budget ended them. They have
    /// their scene, method and seed, the last checkpoint's passes, and the digest of the final image's pixels.
    std::vector<Cell> cells;
    /// Commit, compiler, flags, processor and libraries, by the names that messages use for them.
    std::map<std::string, std::string> machine;
};

/// Throws InputError if the file is missing or not a manifest, or if it does not say how many passes each cell made.
Manifest read_manifest(const std::string& path);
/// Manifest::machine for this program on this processor.
std::map<std::string, std::string> this_machine();

}  // namespace gib
