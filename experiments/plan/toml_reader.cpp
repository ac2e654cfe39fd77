#include "experiments/plan/toml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <tuple>

namespace gib {

namespace {

constexpr int most_dots = 32;  // no key of an experiment file has a dot

/// Whether a byte begins a character of UTF-8, in which continuation bytes are 10xxxxxx. Columns count characters.
bool begins_character(char byte) { return (static_cast<unsigned char>(byte) & 0xc0u) != 0x80u; }

/// Counts the dots of keys before the text is parsed. toml++ bounds how deeply values are nested, but not the number
/// of parts of a dotted key. Each part is a table within the one before, and freeing them recursively could overflow
/// the stack. Dots in comments and in the four kinds of strings do not count.
class DotCounter {
public:
    DotCounter(std::string_view text, const std::string& file) : text_(text), where_{file, 1, 1} {}

    /// Throws InputError at the first dot beyond `most_dots` in one key.
    void require_short_keys() {
        for (int dots = 0; at_ < text_.size();) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') {
                skip_string(c);
                continue;
            }
            if (c == '.' && ++dots > most_dots)
                throw InputError(where_, fmt::format("a key has more than {} dots", most_dots));
            if (std::string_view(",=[]{}\n").find(c) != std::string_view::npos) dots = 0;  // the next key or value
            if (c == '#') skip_comment();
            else advance(1);
        }
    }

private:
    void advance(std::size_t count) {
        for (; count > 0 && at_ < text_.size(); --count, ++at_) {
            if (text_[at_] == '\n') {
                ++where_.line;
                where_.column = 1;
            } else if (begins_character(text_[at_])) {
                ++where_.column;
            }
        }
    }
    void skip_comment() {
        while (at_ < text_.size() && text_[at_] != '\n')
            advance(1);
    }
    void skip_string(char quote) {
        const std::string quotes(3, quote);
        const bool multi_line = text_.substr(at_).starts_with(quotes);
        const std::string_view end = std::string_view(quotes).substr(0, multi_line ? 3 : 1);
        advance(end.size());
        while (at_ < text_.size() && !text_.substr(at_).starts_with(end)) {
            if (text_[at_] == '\n' && !multi_line) return;  // an error that the parser reports
            advance(text_[at_] == '\\' && quote == '"' ? 2 : 1);
        }
        advance(end.size());
        // The string may end with two quotes of its own: of five quotes in a row, the last three end it.
        for (int i = 0; i < 2 && multi_line && at_ < text_.size() && text_[at_] == quote; ++i)
            advance(1);
    }

    std::string_view text_;
    std::size_t at_ = 0;
    SourceLocation where_;
};

toml::table parse(std::string_view text, const std::string& file) {
    DotCounter(text, file).require_short_keys();
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
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.key_at.line, a.key_at.column) < std::tie(b.key_at.line, b.key_at.column);
    });
    return entries;
}

void TomlReader::check_keys(const toml::table& table, std::string_view what,
                            const std::vector<std::string>& known) const {
    for (const auto& entry : entries(table))
        if (std::find(known.begin(), known.end(), entry.key) == known.end())
            throw InputError(entry.key_at, fmt::format("unknown key '{}' in {}; there are: {}", entry.key, what,
                                                       fmt::join(known, ", ")));
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
    if (!node.is_string() || node.as_string()->get().empty())
        throw InputError(at(node), fmt::format("'{}' needs a text in quotes", key));
    return node.as_string()->get();
}

double TomlReader::positive_number(const toml::node& node, std::string_view key) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value) || *value <= 0)
        throw InputError(at(node), fmt::format("'{}' needs a number above 0", key));
    return *value;
}

int TomlReader::whole_number(const toml::node& node, std::string_view key, int lower, int upper) const {
    const auto* value = node.as_integer();
    if (!value || value->get() < lower || value->get() > upper)
        throw InputError(at(node), fmt::format("'{}' needs a whole number from {} to {}", key, lower, upper));
    return static_cast<int>(value->get());
}

const toml::array& TomlReader::filled_array(const toml::node& node, std::string_view key,
                                            std::string_view of_what) const {
    const auto* array = node.as_array();
    if (!array || array->empty()) throw InputError(at(node), fmt::format("'{}' needs a list of {}", key, of_what));
    return *array;
}

const toml::table& TomlReader::table(const toml::node& node, std::string_view key) const {
    const auto* table = node.as_table();
    if (!table) throw InputError(at(node), fmt::format("'{}' needs a table", key));
    return *table;
}

}  // namespace gib
