#pragma once
// How much a run may ask for: on the command line, in an experiment file, and in what a result folder says.

#include <cstdint>

namespace gib {

inline constexpr int most_seeds = 100000;
inline constexpr int most_threads = 4096;
inline constexpr std::int64_t most_passes = std::int64_t{1} << 31;  // the largest spp

}  // namespace gib
