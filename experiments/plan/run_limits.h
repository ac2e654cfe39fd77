#pragma once
// Upper limits for a run's settings, which come from the command line, an experiment file or a result folder.

#include <cstdint>

namespace gib {

inline constexpr int most_seeds = 100000;
inline constexpr int most_threads = 4096;
inline constexpr std::int64_t most_passes = std::int64_t{1} << 31;  // the largest spp

}  // namespace gib
