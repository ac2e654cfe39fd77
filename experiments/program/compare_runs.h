#pragma once
// `gibench compare-runs`: what has changed between two runs of an experiment.

#include "experiments/program/run_comparison.h"
#include "experiments/text/csv.h"

#include <iosfwd>
#include <string>

namespace gib {

struct CompareRunsOptions {
    std::string before, after;  ///< folders of results
    bool csv = false;
    bool fail_if_worse = false;
};

/// The table of --csv. `number` is `error` (relative RMSE after the time `at` [s]) or `seconds` (to the relative RMSE `at`);
/// `before_is_floor` is `yes` where the error was below the noise floor of a reference, which stands in its place.
CsvTable change_table(const RunComparison& comparison);
/// The numbers of each cell in words, the remarks, and a summary.
std::string change_text(const RunComparison& comparison);

/// Prints the changes. Returns 0, or 1 with `fail_if_worse` if a number is worse or nothing is compared.
int compare_runs(const CompareRunsOptions& options, std::ostream& out);

}  // namespace gib
