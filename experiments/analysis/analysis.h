#pragma once
// Computes the numbers of the tables and the report from the stored cells of a result folder.

#include "experiments/analysis/table_row.h"

namespace gib {

/// Reads a result folder and computes its rows. If a cell has no FLIP value yet, it is measured and stored in the
/// folder. Throws InputError if the folder holds no results.
Analysis analyse(const ResultFolder& folder);

}  // namespace gib
