#pragma once
// From stored cells to the numbers of tables and report.

#include "experiments/analysis/table_row.h"

namespace gib {

/// Measures FLIP where a cell has none yet, and keeps it in the folder. Throws InputError if the folder holds no
/// results.
Analysis analyse(const ResultFolder& folder);

}  // namespace gib
