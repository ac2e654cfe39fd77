#pragma once
// What the command line of `gibench run` asks for.

#include <optional>
#include <string>

namespace gib {

struct RepeatPlan;

struct RunOptions {
    std::string experiment;                  ///< path of the file
    std::optional<std::string> out;          ///< folder of the results; else results/<experiment's name>
    int threads = 0;                         ///< 0: one per processor
    std::optional<int> seeds;                ///< instead of the file's
    std::string only;                        ///< keeps cells whose scene or label contains it
    bool fresh = false;                      ///< complete cells are done again
    std::string program = "/proc/self/exe";  ///< that measures a cell
    std::string command_line;                ///< as typed, for the manifest
    const RepeatPlan* repeat = nullptr;      ///< instead of an experiment file
};

}  // namespace gib
