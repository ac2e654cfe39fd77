#pragma once
// Makes table.md and report.html, one file that opens offline, from stored results alone.

#include "experiments/analysis/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// table.md: the totals for people to read, and how good the references are.
std::string markdown_table(const Analysis& analysis);

/// Writes curves.csv, table.csv, table.md, spectra.csv, stages.csv and bias_laws.csv.
void write_tables(const Analysis& analysis, const ResultFolder& folder);

/// Returns the page. `damage`, if given, receives a message for each file that cannot be read and is left out. Throws
/// InputError if an image that the page needs cannot be read.
std::string report_html(const Analysis& analysis, const ResultFolder& folder,
                        std::vector<std::string>* damage = nullptr);

/// Writes report.html and returns its path; `damage` and errors as for report_html().
std::string write_report(const Analysis& analysis, const ResultFolder& folder,
                         std::vector<std::string>* damage = nullptr);

}  // namespace gib
