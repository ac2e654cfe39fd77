#pragma once
// Makes hard_cases.csv, table.md and report.html from the verdicts on all pairs of hard case and method.

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

/// The fields of a row of hard_cases.csv that the reports show, as text.
struct HardCaseLine {
    std::string name, method, expected, got, verdict, lo, hi, relation, reason, why, scene, set;
};

struct HardCaseTable {
    std::string title;
    std::vector<HardCaseLine> lines;  ///< in the order of the file, methods innermost

    std::size_t count(Verdict verdict) const;
    /// Whether no case fails or is unresolved. Cases that are left out or not judged do not count.
    bool all_hold() const { return count(Verdict::fails) == 0 && count(Verdict::unresolved) == 0; }
};

/// The content of hard_cases.csv. Columns: case, method, expected, got, verdict, lo, hi, relation, reason, why,
/// scene, set, passes, seeds, smallest, largest, not_finite, negative, seconds. `got` is the mean radiance [W/(sr
/// m^2)], `lo` and `hi` are the ends of its interval.
CsvTable hard_case_csv(const std::vector<HardCaseRow>& rows);
/// Reads the text of hard_cases.csv. Throws InputError at `file` if it is another table.
HardCaseTable hard_case_table(const std::string& text, const std::string& file, const std::string& title);

/// table.md: first the pairs that do not hold, then a row for each case with its expected answer, a column for each
/// method and the reason for the answer.
std::string hard_case_markdown(const HardCaseTable& table);
/// report.html, with the same content.
std::string hard_case_html(const HardCaseTable& table);

}  // namespace gib
