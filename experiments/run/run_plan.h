#pragma once
// The plan of several processes that run one experiment together (`gibench run --on slurm`): the experiment as the
// first one has read and checked it, and who does what. The plan is a file in the result folder, which is written once
// and read by every task, so that a task loads only the scenes that it renders and another version of the experiment
// file does not reach it.

#include "experiments/measuring/reference_batches.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// A cell by its places in the experiment's lists of scenes and methods.
struct CellPlace {
    std::size_t scene = 0, method = 0;
    std::uint64_t seed = 1;
};

/// A batch of the reference of a scene, by its place in the experiment's list.
struct PlannedBatch {
    std::size_t scene = 0;
    ReferenceBatch batch;
};

/// A cell as it stands in the result folder.
struct CellState {
    CellPlace place;
    std::string scene, method;  ///< name and label
    std::string name;           ///< name of its folder
    bool complete = false;
    std::string failure = {};  ///< message of its last attempt; empty: it has not failed
};

struct RunPlan {
    struct Scene {
        std::string name;
        std::string content_hash;
        std::optional<int> sample_count;  ///< samples a pixel in the file's sampler
        int width = 0, height = 0;        ///< size of its images [pixels]
    };
    /// Names of what a method leaves out in a scene (ResultIndex).
    struct LeftOut {
        std::string scene, method, effects, components;
    };
    std::string experiment, experiment_text;  ///< path and content of the file
    std::string out;                          ///< folder of the results
    std::string only, command_line;           ///< RunOptions
    int threads = 1, seeds = 1;
    std::vector<Scene> scenes = {};         ///< in the experiment's order
    std::vector<std::string> methods = {};  ///< labels, in the experiment's order
    std::vector<LeftOut> left_out = {};
    std::vector<std::vector<PlannedBatch>> batches = {};  ///< batches of references, by task
    std::vector<std::vector<CellPlace>> cells = {};       ///< by task
};

/// The file appears whole or not at all. Throws RunError.
void write_plan(const std::string& path, const RunPlan& plan);
/// Throws InputError if the file is missing or is no plan.
RunPlan read_plan(const std::string& path);

/// Deals out things to at most so many tasks, in order and in parts that differ by one at most.
template <typename Thing>
std::vector<std::vector<Thing>> shared_out(const std::vector<Thing>& things, std::size_t most_tasks) {
    const std::size_t tasks = things.size() < most_tasks ? things.size() : most_tasks;
    std::vector<std::vector<Thing>> parts(tasks);
    for (std::size_t t = 0; t < tasks; ++t)
        for (std::size_t i = things.size() * t / tasks; i < things.size() * (t + 1) / tasks; ++i)
            parts[t].push_back(things[i]);
    return parts;
}

}  // namespace gib
