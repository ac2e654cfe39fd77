#pragma once
// The columns of those sections of table.md and the report that have a row for each method and layer.

#include "experiments/report/columns.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

/// Bits of SectionColumn::sections.
enum RowSection : unsigned { in_prices = 1, in_laws = 2, in_errors = 4, in_outliers = 8, in_noise = 16 };

struct SectionColumn {
    unsigned sections;  ///< the sections that show it
    std::string heading;
    std::string column;  ///< the column of table.csv that holds the same number; may be empty
    RowValue value;
    std::string sentence = "";               ///< its meaning, if it is not that of `column`
    std::optional<std::size_t> target = {};  ///< index into target_errors of the error to which it is the time

    /// The sentence of "How to read this page"; may be empty.
    std::string meaning() const;
};

/// In the order in which the sections show them.
const std::vector<SectionColumn>& section_columns();

}  // namespace gib
