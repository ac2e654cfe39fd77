#pragma once
// `gibench run`: an experiment from its file to its tables and report.

#include <iosfwd>
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

/// Throws InputError if the command line or the current folder's name is not UTF-8, as the records of a run, which name
/// both, have to be: the first record would notice, when much is computed.
void require_utf8_names(const std::string& command_line);

/// Exit code: 0 done, 1 a cell failed (said on stderr), 130 interrupted; what is complete is kept and in the tables.
/// Throws InputError, before anything is computed or written, for whatever is wrong with the experiment.
int run_experiment(const RunOptions& options, std::ostream& out);

}  // namespace gib
