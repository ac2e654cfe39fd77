#pragma once
// The content of table.md and of the report of an analysis, as one list of sections. Texts are Markdown: names stand between
// backquotes.

#include "experiments/analysis/analysis.h"

#include <string>
#include <vector>

namespace gib {

struct Section {
    struct Row {
        std::string scene;
        std::vector<std::string> fields;  ///< one for each column, such as "12.3 (11.2 to 13.5)"
        std::string component = "";       ///< empty: of none; table.md has only the rows of `total` and of none
    };

    std::string title, sentence;
    std::vector<std::string> columns;  ///< none: each row is one sentence, its only field
    std::vector<Row> rows;
};

/// The title of the section that shows each method at equal time; the report has images in its place.
inline constexpr const char* look_title = "Each method at equal time";

/// The sections in their order: a look at each method at equal time, words, tables. Those without rows are left out.
/// table.md prints each of them once, the report those rows of each that belong to a scene. Labels that differ in `spp`
/// alone have to be merged before (same_method.h).
std::vector<Section> sections(const Analysis& analysis);

}  // namespace gib
