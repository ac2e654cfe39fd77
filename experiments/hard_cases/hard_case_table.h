#pragma once
// What became of every hard case by every method: hard_cases.csv, table.md and report.html.

#include "experiments/hard_cases/hard_case.h"
#include "experiments/text/csv.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

struct HardCaseRow {
    HardCase hard;
    std::string method;  ///< label; empty where no method is involved (a scene that must be refused)
    HardCaseImages images;
    HardCaseVerdict verdict;
};

/// What the reports need of a row, as it stands in hard_cases.csv.
struct HardCaseLine {
    std::string name, method, expected, got, verdict, lo, hi, relation, reason, why, scene, set;
};

struct HardCaseTable {
    std::string title;
    std::vector<HardCaseLine> lines;  ///< in the order of the file, methods innermost

    std::size_t count(Verdict verdict) const;
    /// Whether there is nothing but cases that hold, and those that are not for a method.
    bool all_hold() const { return count(Verdict::fails) == 0 && count(Verdict::unresolved) == 0; }
};

/// Columns: case, method, expected, got, verdict, lo, hi, relation, reason, why, scene, set, passes, seeds, smallest,
/// largest, not_finite, negative, seconds. `got` is the mean radiance, `lo` and `hi` its interval.
CsvTable hard_case_csv(const std::vector<HardCaseRow>& rows);
/// From that file's text. Throws InputError at `file` where it is none.
HardCaseTable hard_case_table(const std::string& text, const std::string& file, const std::string& title);

/// What does not hold first, then one line for each case: case, expected, reason, a column for each method.
std::string hard_case_markdown(const HardCaseTable& table);
std::string hard_case_html(const HardCaseTable& table);

}  // namespace gib
