#pragma once
// Compares two runs of an experiment cell by cell: has a change of the program made a method better or worse?
//
// Errors and times of a cell are compared by their logarithms over the seeds, with the pooled scatter of a scene's
// methods (ranking.h). All intervals hold together (Bonferroni): at most one in twenty comparisons of equal runs finds
// a number that is better or worse. The speed of a machine differs between runs, so that a change of time below
// `same_speed` is inconclusive.
//
// `gibench compare-runs`: what has changed between two runs of an experiment.

#include "experiments/analysis/table_row.h"
#include "experiments/text/csv.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace gib {

enum class ChangeVerdict { better, worse, inconclusive, other_machine, busy_machine };
const char* name_of(ChangeVerdict verdict);

/// The probability that equal runs differ in any number.
inline constexpr double change_tail = 0.05;
/// A factor of time within which two runs on one machine count as equally fast.
inline constexpr double same_speed = 1.05;

/// One number of a cell in both runs. Less is better.
struct Change {
    enum class Of { error, error_at_passes, seconds };
    std::string scene, method;      ///< method: its label in the old run
    std::string method_after = {};  ///< its label in the new run
    std::string name = {};  ///< short name of the method (method_names.h), if both runs have the same; else the label
    Of of = Of::error;
    double at =
        0;  ///< of an error: the time [s] or the passes after which it is compared; of seconds: the relative RMSE
    double before = 0, after = 0;  ///< relative RMSE or seconds, means over the seeds as table.csv has them
    bool before_is_floor = false, after_is_floor = false;  ///< the error was below the noise floor and is shown as that
    /// after / before; its interval, of the ratio of geometric means and widened to hold the ratio of these means,
    /// holds together with those of all other changes.
    Estimate factor = {};
    ChangeVerdict verdict = ChangeVerdict::inconclusive;
};

struct RunComparison {
    std::vector<Change> changes;  ///< in the order of scenes, methods, error before seconds
    std::vector<std::string>
        remarks;  ///< what is not compared, and why; which methods are biased against their declaration
    bool has_contradictions = false;  ///< TableRow::contradicted_in of one of the runs
};

/// Compares the totals of those cells that both runs have. A method whose settings have changed has another label; the
/// labels that only one of the runs has are one method if their short names are equal, or else if they alone are left
/// of those whose names begin alike (method_names.h). Errors are compared after the time that the shorter of both runs
/// took; where a busy machine or another one makes times useless, also after the passes that the shorter of both made.
/// An error below the noise floor of a reference counts as that floor. Times are compared where all seeds of both runs
/// have reached an error.
RunComparison compare_runs(const Analysis& before, const Analysis& after);

struct CompareRunsOptions {
    std::string before, after;  ///< folders of results
    bool csv = false;
    bool fail_if_worse = false;
};

/// The table of --csv. `number` is `error` (relative RMSE after the time `at` [s]), `error_at_passes` (after `at`
/// passes) or `seconds` (to the relative RMSE `at`);
/// `before_is_floor` is `yes` where the error was below the noise floor of a reference and is replaced by it.
CsvTable change_table(const RunComparison& comparison);
/// The numbers of each cell in words, the remarks, and a summary.
std::string change_text(const RunComparison& comparison);

/// Prints the changes. Returns 0, or 1 with `fail_if_worse` if a number is worse, a method is biased against its
/// declaration, or nothing is compared.
int compare_runs(const CompareRunsOptions& options, std::ostream& out);

}  // namespace gib
