#pragma once
// `gibench tune`: the settings of each method with the least time to an error on one scene.

#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

struct TuneOptions {
    std::string scene;
    std::string target = "2%";            ///< relative RMSE
    std::vector<std::string> methods;     ///< labels, whose settings stay; empty: every method that estimates radiance
    std::vector<std::string> variations;  ///< such as "photons=1e4..1e7"
    double minutes = 20;                  ///< for references, search and final measurement, roughly
    int threads = 0;                      ///< 0: one per processor
    std::optional<std::pair<int, int>> resolution;
    std::vector<std::string> folders = {};  ///< searched for the scene's files
    std::optional<std::string> out;         ///< folder of the results; else results/tune-SCENE
    std::string program = "/proc/self/exe";
    std::string command_line = {};  ///< as typed, for the manifests
};

/// Searches, measures the best settings with fresh seeds and prints them to `out`, the best label first. Every round of
/// the search is an experiment in a folder of its own, `METHOD-ROUND`, and the final measurement one in `final`; the same
/// command goes on after an interruption. Returns the exit code: 0 found, 1 no method reached the target, 130
/// interrupted. Throws InputError.
int tune(const TuneOptions& options, std::ostream& out);

}  // namespace gib
