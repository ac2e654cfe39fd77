#pragma once
// The content of table.md and of the report, as one list of sections. Texts are Markdown: names are between backquotes.

#include "experiments/analysis/analysis.h"
#include "experiments/report/columns.h"

#include <string>
#include <vector>

namespace gib {

/// The rank of a field in its column.
enum class Mark { none, best, tie, grey };

/// A field of a table.
struct Entry {
    Shown shown;
    Mark mark = Mark::none;
    std::string method = "";          ///< the label whose colour it has
    std::string remark = "";          ///< below a text; in brackets in Markdown
    std::vector<double> shares = {};  ///< drawn as a bar beside it
};

struct Section {
    enum class Kind { warnings, verdict, words, table, looks, noise, bias_laws, stages };
    struct Column {
        std::string heading;
        bool of_words = false;  ///< words are aligned on the left
    };
    struct Row {
        std::string scene;
        std::vector<Entry> entries = {};  ///< one for each column
        std::optional<Layer> layer = {};  ///< empty: of none; table.md has only the rows of the total and of none
        std::string sentence = "";        ///< of a section without columns
        bool is_warning = false;
    };

    std::string title, sentence;
    std::vector<Column> columns;
    std::vector<Row> rows = {};
    Kind kind = Kind::table;
};

/// The sections in their order: warnings, a look at each method at equal time, words, tables. Those without rows are
/// left out. table.md prints each of them once, the report those rows of each that belong to a scene. Labels that
/// differ in
/// `spp` alone have to be merged before (method_names.h).
std::vector<Section> sections(const Analysis& analysis);

/// "12.3 (11.0 to 14.1)": a field as table.md prints it.
std::string line_of(const Shown& shown);

}  // namespace gib
