#include "experiments/text/csv.h"

#include <fmt/format.h>

#include <stdexcept>

namespace gib {

namespace {

std::string quoted_field(const std::string& field) {
    if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
    std::string text = "\"";
    for (const char c : field) {
        if (c == '"') text += '"';
        text += c;
    }
    return text + '"';
}

void append_row(std::string& text, const std::vector<std::string>& row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (i > 0) text += ',';
        text += quoted_field(row[i]);
    }
    text += '\n';
}

}  // namespace

void CsvTable::add(std::vector<std::string> row) {
    if (row.size() != columns.size())
        throw std::logic_error(fmt::format("a row of {} fields for {} columns", row.size(), columns.size()));
    rows.push_back(std::move(row));
}

std::string CsvTable::text() const {
    std::string text;
    append_row(text, columns);
    for (const auto& row : rows)
        append_row(text, row);
    return text;
}

}  // namespace gib
