#pragma once
// Reads the CSV files that the program writes.

#include "common/core/error.h"
#include "experiments/text/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// All records, the header included.
inline std::vector<std::vector<std::string>> csv_records_in(std::string_view text, const std::string& file) {
    std::vector<std::vector<std::string>> records(1);
    std::string field;
    bool in_quotes = false;
    int line = 1;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') ++line;
        if (in_quotes) {
            if (c != '"') field += c;
            else if (i + 1 < text.size() && text[i + 1] == '"') field += text[++i];
            else in_quotes = false;
        } else if (c == '"') {
            in_quotes = true;
        } else if (c == ',') {
            records.back().push_back(std::move(field));
            field.clear();
        } else if (c == '\n') {
            records.back().push_back(std::move(field));
            field.clear();
            records.emplace_back();
        } else if (c != '\r') {
            field += c;
        }
    }
    if (in_quotes) throw InputError({file, line, 1}, "a quoted field does not end");
    if (!field.empty() || !records.back().empty()) records.back().push_back(std::move(field));
    else records.pop_back();
    return records;
}

/// The inverse of CsvTable::text(). Throws InputError at `file` for rows of a wrong length and for open quotes.
inline CsvTable parse_csv(std::string_view text, const std::string& file) {
    auto records = csv_records_in(text, file);
    if (records.empty()) throw InputError({file}, "the table is empty");
    CsvTable table;
    table.columns = std::move(records.front());
    for (std::size_t i = 1; i < records.size(); ++i) {
        if (records[i].size() != table.columns.size())
            throw InputError({file, static_cast<int>(i) + 1, 1},
                             fmt::format("{} fields for {} columns", records[i].size(), table.columns.size()));
        table.rows.push_back(std::move(records[i]));
    }
    return table;
}

/// A row's field in this column. Throws std::out_of_range if there is no such row or column.
inline const std::string& field_of(const CsvTable& table, const std::string& column, std::size_t row = 0) {
    const auto at = std::find(table.columns.begin(), table.columns.end(), column) - table.columns.begin();
    return table.rows.at(row).at(static_cast<std::size_t>(at));
}

}  // namespace gib
