#pragma once
// `gibench compare`: measures images of any renderer against a reference.

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace gib {

struct CompareOptions {
    std::vector<std::string> tests;      ///< files; several are replicates of one method with different seeds
    std::string reference;               ///< a file, with or without standard errors
    std::optional<double> epsilon = {};  ///< epsilon of relative errors [radiance^2]; none: the default (epsilon.h)
    bool json = false;
    bool other_scene = false;  ///< accept images of other scenes than the reference's
    std::string png = {};      ///< file for a picture of the difference; empty: none
    bool z_test = false;       ///< test whether the images differ by noise alone
};

/// Prints the metrics as text or as JSON with the column names of table.csv; a number that is undefined is `-` or
/// null. Returns 0, or 1 if the z-test rejects. Throws InputError for wrong options, wrong files and different sizes.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace gib
