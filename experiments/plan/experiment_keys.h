#pragma once
// The keys of experiment files.

#include "experiments/text/declared.h"

namespace gib {

/// The tables of an experiment file, in the order in which a user meets them.
const std::vector<DeclaredTable>& experiment_keys();

}  // namespace gib
