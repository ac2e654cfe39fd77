#pragma once
// CSV files as RFC 4180 has them: fields with a comma, a quote or a line break are quoted, quotes are doubled.

#include <string>
#include <string_view>
#include <vector>

namespace gib {

struct CsvTable {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;  ///< as many fields each as there are columns

    /// Throws std::logic_error if the number of fields is wrong.
    void add(std::vector<std::string> row);
    std::string text() const;
};

/// The inverse of CsvTable::text(). Throws InputError at `file` for rows of a wrong length and for open quotes.
CsvTable parse_csv(std::string_view text, const std::string& file);

}  // namespace gib
