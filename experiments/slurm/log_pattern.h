#pragma once
// Paths in the options of sbatch that take patterns.

#include <string>

namespace gib {

/// A path as sbatch's --output takes it, where % begins a replacement symbol and %% stands for %. Throws InputError for a
/// backslash, which would switch off all replacement symbols of the pattern (sbatch(1), "filename pattern").
std::string log_pattern(const std::string& path);

}  // namespace gib
