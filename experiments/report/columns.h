#pragma once
// The columns of table.csv. Their order: names, error, bias and noise, times, frequencies of the noise, cost, the rest.

#include "experiments/analysis/row_fields.h"
#include "experiments/report/words.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace gib {

/// A field of a table.
using Shown = std::variant<std::string, Field>;

/// The entry of a row in a column: a number with its state, or words.
using RowValue = std::variant<Field (*)(const TableRow&), std::string (*)(const TableRow&)>;
Shown shown(const RowValue& value, const TableRow& row);

template <std::size_t target>
Field time_to(const TableRow& row) {
    return time_field(row, target);
}

struct RowColumn {
    std::string name, unit, sentence;
    RowValue value;
    int percent = 0;  ///< level of the interval in NAME_lo and NAME_hi; 0: none
};

/// "16", or "12 to 16": the least and the most passes of the seeds.
std::string passes_text(std::uint32_t least, std::uint32_t most);
/// The passes of a row's final images.
std::string passes_of(const TableRow& row);

/// In the order of table.csv.
const std::vector<RowColumn>& row_columns();

/// The fields of a row, in the order of row_columns() with the ends of the intervals. A number that was not
/// measured is empty; NAME_lo and NAME_hi hold the interval of an extrapolation, NAME_lo alone a lower bound.
std::vector<std::string> csv_fields(const TableRow& row);

}  // namespace gib
