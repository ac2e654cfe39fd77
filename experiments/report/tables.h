#pragma once
// The CSV files of a result folder.

#include "experiments/analysis/analysis.h"
#include "experiments/text/csv.h"
#include "experiments/text/declared.h"

#include <vector>

namespace gib {

/// The CSV files and their columns.
const std::vector<DeclaredTable>& csv_files();

CsvTable curves_table(const Analysis& analysis);
CsvTable error_table(const Analysis& analysis);
CsvTable spectra_table(const Analysis& analysis);
CsvTable stages_table(const Analysis& analysis);
CsvTable bias_law_table(const Analysis& analysis);

}  // namespace gib
