#pragma once
// The options that the command line of `gibench run` gives.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace gib {

// Upper limits for a run's settings.
inline constexpr int most_seeds = 100000;
inline constexpr int most_budget_passes = 1 << 30;
inline constexpr int most_threads = 4096;
inline constexpr int most_pixels_across = 1 << 16;

// Defaults of an experiment file.
inline constexpr int default_seeds = 1;
inline constexpr std::string_view default_tuning_target = "2%";
inline constexpr double default_tuning_minutes = 20;

/// One of several parts of an experiment, which any machine may run: the cells at places p with p mod `count` =
/// `index`.
struct RunShare {
    std::size_t index = 0, count = 1;

    bool has(std::size_t place) const { return place % count == index; }
};

struct RunOptions {
    std::string experiment;              ///< path of the file
    std::optional<std::string> out;      ///< folder of the results; else results/<experiment's name>
    int threads = 0;                     ///< 0: one per processor
    std::optional<int> seeds;            ///< number of seeds, instead of the file's
    std::string only;                    ///< keeps only cells whose scene, label or short name contains this
    bool fresh = false;                  ///< whether complete cells are done again
    std::string command_line;            ///< as typed, for the manifest
    bool quiet = false;                  ///< no progress, no verdict
    std::optional<RunShare> share = {};  ///< part that this process runs; none: everything, tables and report too
};

}  // namespace gib
