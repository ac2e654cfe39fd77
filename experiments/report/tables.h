#pragma once
// Makes the tables of a result folder. The order of their columns does not change; new ones are added at the end.

#include "experiments/analysis/analysis.h"
#include "experiments/text/csv.h"
#include "experiments/text/declared.h"

namespace gib {

/// The CSV files and their columns.
const std::vector<DeclaredTable>& csv_files();

CsvTable curves_table(const Analysis& analysis);
CsvTable error_table(const Analysis& analysis);
CsvTable spectra_table(const Analysis& analysis);
CsvTable stages_table(const Analysis& analysis);
CsvTable bias_law_table(const Analysis& analysis);

/// Writes curves.csv, table.csv, table.md, spectra.csv, stages.csv and bias_laws.csv.
void write_tables(const Analysis& analysis, const ResultFolder& folder);

}  // namespace gib
