#pragma once
// Writes CSV files (RFC 4180): fields with a comma, quote or line break are quoted, and quotes are doubled.

#include <string>
#include <vector>

namespace gib {

struct CsvTable {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;  ///< each with a field for every column

    /// Throws std::logic_error if the number of fields is wrong.
    void add(std::vector<std::string> row);
    std::string text() const;
};

}  // namespace gib
