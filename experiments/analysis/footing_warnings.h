#pragma once
// Warnings where a scene's methods are not on an equal footing, for the tables and the report.

#include "experiments/analysis/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// The components of a method whose mean energy is not the reference's, or of which that is not known.
struct FootingWarning {
    std::string scene, method;
    std::string component;  ///< names, separated by `;`
    bool differs;           ///< else it is not resolved
    std::string text;       ///< a sentence that names all three
};
/// First one for each method with components that differ from the reference; then, where the reference cannot judge a
/// component of several methods, one for the two that differ most surely from each other; then one for each method with
/// components that are not resolved.
std::vector<FootingWarning> footing_warnings(const Analysis& analysis);

/// The section of table.md that stands before every number.
std::string footing_text(const Analysis& analysis);

}  // namespace gib
