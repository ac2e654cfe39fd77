#include "experiments/text/json_file.h"

#include "common/core/error.h"
#include "common/core/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>

namespace gib {

namespace {

constexpr int deepest = 64;  // levels; files of gibench have 5 at most

/// The number of nested levels in a JSON text; for another text any number. The parser's callbacks could count them,
/// but with them the time of parsing is quadratic in the length of a list of objects.
int nesting_of(std::string_view text) {
    int depth = 0, deepest_seen = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"') in_string = !in_string;
        else if (in_string) i += c == '\\' ? 1 : 0;
        else if (c == '[' || c == '{') deepest_seen = std::max(deepest_seen, ++depth);
        else if (c == ']' || c == '}') --depth;
    }
    return deepest_seen;
}

}  // namespace

nlohmann::json read_json(const std::string& path) {
    const std::string text = read_file(path);
    if (nesting_of(text) > deepest) throw InputError({path}, fmt::format("nested more than {} levels deep", deepest));
    return nlohmann::json::parse(text);
}

std::string json_digest(const nlohmann::json& record) {
    ContentHash hash;
    hash.add(record.dump());
    return hash.hex();
}

}  // namespace gib
