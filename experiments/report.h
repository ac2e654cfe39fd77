#pragma once
// report.html: one file that opens offline, made from stored results alone.

#include "experiments/analysis.h"

#include <string>

namespace gib {

/// The page. Throws InputError if an image of the folder cannot be read.
std::string report_html(const Analysis& analysis, const ResultFolder& folder);

/// Writes report.html; returns its path.
std::string write_report(const Analysis& analysis, const ResultFolder& folder);

}  // namespace gib
