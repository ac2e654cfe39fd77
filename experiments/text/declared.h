#pragma once
// Names that users write or read, each declared once: the keys of experiment files and the columns of CSV files.
// Reading, writing and `gibench list` share the declaration.

#include <string>
#include <vector>

namespace gib {

struct Declared {
    std::string name;
    std::string value;     ///< unit of a column; type, range and default of a key
    std::string sentence;  ///< meaning, with Markdown's marks for code
};

/// A table of an experiment file with its keys, or a CSV file with its columns.
struct DeclaredTable {
    std::string name, sentence;
    std::vector<Declared> entries;
    std::string others = {};  ///< meaning of any other name; empty: there is none
};

/// The names of the entries, in order.
inline std::vector<std::string> names_of(const std::vector<DeclaredTable>& tables, const std::string& table) {
    std::vector<std::string> names;
    for (const auto& candidate : tables)
        if (candidate.name == table)
            for (const auto& entry : candidate.entries)
                names.push_back(entry.name);
    return names;
}

}  // namespace gib
