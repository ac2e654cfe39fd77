#pragma once
// Prints fields: in words and tables, and in CSV files.

#include "experiments/analysis/field.h"

#include <string>

namespace gib {

/// A field of a table: Markdown has `detail` in brackets, the page in small letters below.
struct FieldText {
    std::string value, detail;
};

/// "12.3" with "11.0 to 14.1"; "42.0" with "extrapolated, 35.1 to 50.2"; "never" with "floor 3.00 %". `unit` follows each
/// number, as in sentences.
FieldText text_of(const Field& field, const std::string& unit = "");
/// Both on one line: "12.3 (11.0 to 14.1)".
std::string line_of(const Field& field, const std::string& unit = "");

/// The number of a measured field; empty for all others.
std::string csv_text(const Field& field);
/// The state in words; empty if there is none.
std::string csv_state(const Field& field);

}  // namespace gib
