#pragma once
// report.html: one file that opens offline, made from stored results alone.

#include "experiments/analysis/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// The page. `damage`, if given, is told what cannot be read and is left out. Throws InputError if an image cannot be
/// read that the page cannot do without.
std::string report_html(const Analysis& analysis, const ResultFolder& folder,
                        std::vector<std::string>* damage = nullptr);

/// Writes report.html; returns its path.
std::string write_report(const Analysis& analysis, const ResultFolder& folder,
                         std::vector<std::string>* damage = nullptr);

}  // namespace gib
