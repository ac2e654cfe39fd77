#pragma once
// Runs a file of hard cases (`gibench run`).

#include "experiments/plan/run_options.h"

#include <iosfwd>
#include <string>

namespace gib {

/// Judges every case by every method, each pair in a process of its own, and writes hard_cases.csv, table.md,
/// report.html and manifest.json. Returns the exit code: 0 if all hold, 1 if one does not (stderr says which), 130 if
/// interrupted (then nothing is written). `options.only` keeps the pairs whose case name or method label contains it.
/// Throws InputError, before anything is computed, if the file is wrong.
int run_hard_cases(const RunOptions& options, std::ostream& out);

/// Runs in the child: renders one pair and prints its HardCaseImages as JSON. An empty label stands for `path`; it is
/// used for scenes that must be refused, whatever the method.
void judge_case(const std::string& file, const std::string& name, const std::string& label, int seeds,
                std::ostream& out);

/// Whether a folder holds the results of hard cases.
bool holds_hard_case_results(const std::string& folder);
/// Writes table.md and report.html again from hard_cases.csv and manifest.json. Returns the report's path.
std::string rebuild_hard_case_report(const std::string& folder);

}  // namespace gib
