#pragma once
// Warnings, for the tables and the report, where the methods
// of a scene are not on an equal footing (equal_footing.h).

#include "experiments/analysis/table_row.h"

#include <vector>

namespace gib {

/// Warnings that name method and layers: one for each method with layers that differ from the reference; and, where the
/// reference cannot judge a component of several methods, one for the two methods that differ most surely from each other.
std::vector<Warning> footing_warnings(const Analysis& analysis);

}  // namespace gib
