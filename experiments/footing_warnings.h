#pragma once
// Warnings where a scene's methods are not on an equal footing, for the tables and the report.

#include "experiments/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// A component of a method whose mean energy is not the reference's, or not known to be.
struct FootingWarning {
    std::string scene, method, component;
    bool differs;      ///< else it is not resolved
    std::string text;  ///< a sentence that names all three
};
/// In the order of the rows, those that differ first.
std::vector<FootingWarning> footing_warnings(const Analysis& analysis);

/// The section of table.md that stands before every number.
std::string footing_text(const Analysis& analysis);

}  // namespace gib
