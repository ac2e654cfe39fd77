#pragma once
// The options of a tuning.

#include "experiments/tuning/search_space.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

struct TuneOptions {
    std::string scene;
    std::string target = "2%";         ///< relative RMSE
    std::vector<std::string> methods;  ///< labels, whose settings stay; empty: every method that estimates radiance
    std::vector<Variation> variations;
    double minutes = 20;  ///< time for reference, search and final runs; no run begins later
    int threads = 0;      ///< 0: one per processor
    std::optional<std::pair<int, int>> resolution;
    std::optional<double> epsilon = {};     ///< epsilon of relative errors [radiance^2]; none: the default (epsilon.h)
    std::vector<std::string> folders = {};  ///< searched for the scene's files
    std::optional<std::string> out;         ///< folder of the results; else results/tune-SCENE
    std::string program = "/proc/self/exe";
    std::string command_line = {};  ///< as typed, for the manifests
};

}  // namespace gib
