#pragma once
// Functions for benchmarks that compare two pieces of work. Both run in turn within each iteration, so that a machine
// whose speed drifts favours neither, and the median ratio of the pairs is reported.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace gib {

/// The path of a file in scenes/.
inline std::string path_of(const std::string& file) { return std::string(GIB_SOURCE_DIR) + "/scenes/" + file; }

/// Whether the mesh file exists, which has to be made before; if not, the benchmark ends with an error that says so.
inline bool is_there(benchmark::State& state, const std::string& mesh) {
    if (std::filesystem::exists(path_of(mesh))) return true;
    state.SkipWithError("its mesh is not there: run scripts/meshes");
    return false;
}

template <typename Work>
double seconds(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline void report_median(benchmark::State& state, std::vector<double> ratios) {
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    state.counters["ratio"] = *middle;
    state.counters["pairs"] = static_cast<double>(ratios.size());
}

}  // namespace gib
