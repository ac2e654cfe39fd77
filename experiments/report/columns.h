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
    int percent = 0;  ///< level of the interval whose ends stand in NAME_lo and NAME_hi; 0: there are none
};

/// "16", or "12 to 16": the least and the most passes of the seeds.
std::string passes_text(std::uint32_t least, std::uint32_t most);
/// Those of a row's final images.
std::string passes_of(const TableRow& row);

/// In the order of table.csv.
const std::vector<RowColumn>& row_columns();

/// The fields of a row, in the order of row_columns() with the ends of the intervals. A number is empty where it was
/// not measured; its ends then are those of an extrapolation, and a lower bound stands in NAME_lo.
std::vector<std::string> csv_fields(const TableRow& row);

}  // namespace gib
