#pragma once
// Warnings, for the tables and the report, where the methods
// of a scene are not on an equal footing (equal_footing.h).

#include "experiments/analysis/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// A warning about a method in one scene: in some components its mean energy differs from the reference's, or this is
/// not known.
struct FootingWarning {
    std::string scene, method;
    bool differs;      ///< true: the energy differs; false: this is not known
    std::string text;  ///< a sentence that names method and components
};
/// The warnings come in three parts: one for each method with components that differ from the reference; where the
/// reference cannot judge a component of several methods, one for the two methods that differ most surely from each
/// other; one for each method with components that are not resolved.
std::vector<FootingWarning> footing_warnings(const Analysis& analysis);

}  // namespace gib
