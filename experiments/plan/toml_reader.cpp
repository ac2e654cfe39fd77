#include "experiments/plan/toml_reader.h"

#include "common/core/nearest_word.h"
#include "common/core/reject.h"
#include "experiments/plan/experiment_keys.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <tuple>

namespace gib {

namespace {

/// Whether a byte begins a character of UTF-8, in which continuation bytes are 10xxxxxx. Columns count characters.
bool begins_character(char byte) { return (static_cast<unsigned char>(byte) & 0xc0u) != 0x80u; }

toml::table parse(std::string_view text, const std::string& file) {
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& error) {
        const auto& begin = error.source().begin;
        throw InputError({file, static_cast<int>(begin.line), static_cast<int>(begin.column)},
                         std::string(error.description()));
    }
}

/// Removes the byte order mark that some editors put before UTF-8. toml++ skips it, so that it has no column.
std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.remove_prefix(mark.size());
    return text;
}

std::vector<std::string> lines_of(std::string_view text) {
    std::vector<std::string> lines;
    std::istringstream stream{std::string(text)};
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

}  // namespace

TomlReader::TomlReader(std::string_view text, std::string file)
    : file_(std::move(file)),
      lines_(lines_of(without_byte_order_mark(text))),
      root_(parse(without_byte_order_mark(text), file_)) {}

SourceLocation TomlReader::at(const toml::source_region& region) const {
    return {file_, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

std::vector<TomlReader::Entry> TomlReader::entries(const toml::table& table) const {
    std::vector<Entry> entries;
    for (const auto& [key, value] : table)
        entries.push_back({std::string(key.str()), at(key.source()), &value});
    std::ranges::stable_sort(entries, [](const Entry& a, const Entry& b) {
        return std::tie(a.key_at.line, a.key_at.column) < std::tie(b.key_at.line, b.key_at.column);
    });
    return entries;
}

void TomlReader::check_keys(const toml::table& table, std::string_view what,
                            const std::vector<std::string>& known) const {
    for (const auto& entry : entries(table))
        if (std::ranges::find(known, entry.key) == known.end())
            reject(entry.key_at, "unknown key '{}' in {}{} There are: {}", entry.key, what,
                   &table == &root_ ? did_you_mean_or_stop(entry.key, known) : help_with_key(entry.key, known),
                   fmt::join(known, ", "));
}

std::string TomlReader::typed_at(const toml::source_position& position) const {
    if (position.line < 1 || position.line > lines_.size()) return "";
    const std::string& line = lines_[position.line - 1];
    // The columns of toml++ count characters (code points) too.
    std::size_t begin = 0;
    for (std::size_t column = 1; begin < line.size() && column < position.column; ++column) {
        ++begin;
        while (begin < line.size() && !begins_character(line[begin]))
            ++begin;
    }
    const std::size_t end = std::min(line.find_first_of(",]} \t\r#", begin), line.size());
    return line.substr(begin, end - begin);
}

std::string TomlReader::text_of(const toml::node& node) const {
    if (const auto* string = node.as_string()) return string->get();
    std::string text = typed_at(node.source().begin);
    text.erase(std::remove(text.begin(), text.end(), '_'), text.end());
    return text;
}

std::string TomlReader::string(const toml::node& node, std::string_view key) const {
    if (!node.is_string() || node.as_string()->get().empty()) reject(at(node), "'{}' needs a text in quotes", key);
    return node.as_string()->get();
}

double TomlReader::positive_number(const toml::node& node, std::string_view key) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value) || *value <= 0) reject(at(node), "'{}' needs a number above 0", key);
    return *value;
}

int TomlReader::whole_number(const toml::node& node, std::string_view key, int lower, int upper) const {
    const auto* value = node.as_integer();
    if (!value || value->get() < lower || value->get() > upper)
        reject(at(node), "'{}' needs a whole number from {} to {}", key, lower, upper);
    return static_cast<int>(value->get());
}

const toml::array& TomlReader::filled_array(const toml::node& node, std::string_view key,
                                            std::string_view of_what) const {
    const auto* array = node.as_array();
    if (!array || array->empty()) reject(at(node), "'{}' needs a list of {}", key, of_what);
    return *array;
}

const toml::table& TomlReader::table(const toml::node& node, std::string_view key) const {
    const auto* table = node.as_table();
    if (!table) reject(at(node), "'{}' needs a table", key);
    return *table;
}

}  // namespace gib
