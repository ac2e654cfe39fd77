#pragma once
// The work of a repeated run (`gibench run --repeat`): the cells and passes of the run that it repeats.

#include "experiments/plan/experiment_file.h"
#include "experiments/results/result_folder.h"

#include <cstdint>
#include <map>
#include <string>

namespace gib {

/// A run that has such a plan follows it instead of its experiment file.
struct RepeatPlan {
    Experiment experiment;
    ResultFolder original;
    std::map<std::string, std::uint32_t> passes = {};      ///< by the folder name of a complete cell
    std::map<std::string, std::string> scene_hashes = {};  ///< by name, of the scenes with complete cells
    std::map<std::string, std::string> references = {};    ///< identities by the scene's name

    bool has_cells_of(const std::string& scene, const std::string& method) const;
    std::string reference_of(const std::string& scene) const;
    /// Throws InputError, with the scene's file, if the scene's content has changed since the run.
    void check_scene(const ExperimentScene& scene, const std::string& content_hash) const;
};

}  // namespace gib
