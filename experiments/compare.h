#pragma once
// `gibench compare`: images of any renderer against a reference.

#include <iosfwd>
#include <string>
#include <vector>

namespace gib {

struct CompareOptions {
    std::vector<std::string> tests;  ///< files; several are replicates of one method with different seeds
    std::string reference;           ///< a file, with or without standard errors
    double epsilon = 0.01;           ///< of the relative error's denominator [radiance^2], > 0
    bool json = false;
};

/// Prints the metrics as text or as JSON with the column names of table.csv; null (or `-`) where a number is undefined.
/// Returns 0. Throws InputError for wrong files, and for sizes that differ.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace gib
