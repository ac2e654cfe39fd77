#include "experiments/text/csv.h"

#include "common/core/error.h"

#include <fmt/format.h>

#include <stdexcept>

namespace gib {

namespace {

std::string quoted(const std::string& field) {
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
        text += quoted(row[i]);
    }
    text += '\n';
}

/// All records, the header included.
std::vector<std::vector<std::string>> records_in(std::string_view text, const std::string& file) {
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

CsvTable parse_csv(std::string_view text, const std::string& file) {
    auto records = records_in(text, file);
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

}  // namespace gib
