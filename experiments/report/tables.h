#pragma once
// The tables of a result folder. The order of their columns does not change; new ones are added at the end. Each number of a row
// is one entry, which gives its column of table.csv, its columns in the sections that table.md and the report show, and its line
// in "How to read this page".

#include "experiments/analysis/analysis.h"
#include "experiments/analysis/table_row.h"
#include "experiments/text/csv.h"
#include "experiments/text/declared.h"

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gib {

/// The sections with a row for each method and layer; bits of RowColumn::sections.
enum RowSection : unsigned { in_prices = 1, in_laws = 2, in_errors = 4, in_outliers = 8, in_noise = 16 };

/// A row as a section shows it.
using Shown = std::variant<std::string, Field>;

/// A column of table.csv; without a name, only sections show it.
struct RowColumn : Declared {
    std::function<std::string(const TableRow&)> csv;   ///< empty where it is undefined or was never reached
    unsigned sections = 0;                             ///< the sections that show it
    std::string heading = "";                          ///< its column there
    std::function<Shown(const TableRow&)> shown = {};  ///< its field there
    bool of_words = false;                             ///< whether its field holds words, which stand on the left
    std::optional<std::size_t> target = {};  ///< index into target_errors of the error to which it is the time
    std::string meaning = "";                ///< of the field that sections show, if `sentence` does not say it
};

/// "16", or "12 to 16": the least and the most passes of the seeds.
std::string passes_text(std::uint32_t least, std::uint32_t most);

/// All entries in the order of table.csv. This order does not change; new ones are added at the end.
const std::vector<RowColumn>& row_columns();

/// The CSV files and their columns.
const std::vector<DeclaredTable>& csv_files();

CsvTable curves_table(const Analysis& analysis);
CsvTable error_table(const Analysis& analysis);
CsvTable spectra_table(const Analysis& analysis);
CsvTable stages_table(const Analysis& analysis);
CsvTable bias_law_table(const Analysis& analysis);

}  // namespace gib
