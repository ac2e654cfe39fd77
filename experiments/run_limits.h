#pragma once
// How much a run may ask for: on the command line, in an experiment file, and in what a result folder says.

namespace gib {

inline constexpr int most_seeds = 100000;
inline constexpr int most_threads = 4096;

}  // namespace gib
