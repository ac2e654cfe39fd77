#include "tests/machine/run_content.h"
#include "tests/support/csv_reader.h"

#include "common/core/files.h"
#include "common/images/image_digest.h"

#include <filesystem>
#include <set>
#include <vector>

namespace gib::test {

namespace {

/// The columns that no clock and no other process can change.
std::set<std::string> repeatable(const std::vector<std::string>& columns) {
    std::set<std::string> kept;
    for (const auto& name : columns)
        if (name.find("seconds") == std::string::npos && name.find("rss") == std::string::npos) kept.insert(name);
    return kept;
}

}  // namespace

std::map<std::string, std::string> content_of(const std::string& folder) {
    std::map<std::string, std::string> content;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string name = std::filesystem::relative(entry.path(), folder).string();
        const auto ending = entry.path().extension();
        const std::string path = entry.path().string();
        // The file of a reference records how long it took to make, so only its pixels are compared.
        if (name.find("-reference.exr") != std::string::npos) content[name] = image_digest(read_image(path));
        else content[name] = ending == ".exr" || ending == ".png" ? read_file(path) : "";
    }
    const CsvTable table = parse_csv(read_file(folder + "/table.csv"), "table.csv");
    const auto kept = repeatable(table.columns);
    std::string text;
    for (const auto& row : table.rows)
        for (std::size_t i = 0; i < row.size(); ++i)
            if (kept.count(table.columns[i]) > 0) text += table.columns[i] + "=" + row[i] + "\n";
    content["table.csv"] = text;
    return content;
}

}  // namespace gib::test
