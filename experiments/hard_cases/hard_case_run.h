#pragma once
// `gibench run` for a file of hard cases.

#include "experiments/plan/run_options.h"

#include <iosfwd>
#include <string>

namespace gib {

/// Judges every case by every method, each pair in a process of its own, and writes hard_cases.csv, table.md,
/// report.html and manifest.json. Exit code: 0 all hold, 1 one does not (said on stderr), 130 interrupted (then nothing
/// is written). `only` keeps the pairs whose case or label contains it. Throws InputError before anything is computed
/// for whatever is wrong with the file.
int run_hard_cases(const RunOptions& options, std::ostream& out);

/// The child's side of one pair: prints the images as JSON. An empty label only loads the scene.
void judge_case(const std::string& file, const std::string& name, const std::string& label, int seeds,
                std::ostream& out);

/// Whether a folder holds the results of hard cases.
bool holds_hard_case_results(const std::string& folder);
/// table.md and report.html from hard_cases.csv; returns the report's path.
std::string rebuild_hard_case_report(const std::string& folder);

}  // namespace gib
