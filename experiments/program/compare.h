#pragma once
// `gibench compare`: images of any renderer against a reference.

#include "experiments/plan/epsilon.h"

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace gib {

struct CompareOptions {
    std::vector<std::string> tests;    ///< files; several are replicates of one method with different seeds
    std::string reference;             ///< a file, with or without standard errors
    double epsilon = default_epsilon;  ///< of the relative error's denominator [radiance^2], > 0
    bool json = false;
    bool z_test = false;         ///< decide whether the test is the reference but for noise
    std::string variance = {};   ///< a file: Mitsuba's test instead of our own, of a single test
    std::uint32_t test_spp = 0;  ///< samples a pixel of that test, > 0 with `variance`
};

/// Prints the metrics as text or as JSON with the column names of table.csv; null (or `-`) where a number is undefined.
/// Returns 0, or 1 if the z-test rejects. Throws InputError for wrong options and files, and for sizes that differ.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace gib
