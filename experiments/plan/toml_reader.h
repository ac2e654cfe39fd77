#pragma once
// Reads TOML with toml++ and adds what good messages need: the order in which keys were typed, numbers as typed, and
// checks of types that give the place in the file.

#include "common/core/error.h"

#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

namespace gib {

class TomlReader {
public:
    /// Parses `text`. Throws InputError with the message of the parser at its place in `file`.
    TomlReader(std::string_view text, std::string file);

    struct Entry {
        std::string key;
        SourceLocation key_at;
        const toml::node* value;
    };

    const toml::table& root() const { return root_; }
    SourceLocation at(const toml::node& node) const { return at(node.source()); }
    /// The entries of a table in the order of the file; toml++ itself sorts them by key.
    std::vector<Entry> entries(const toml::table& table) const;
    /// Throws InputError at the first key that is not `known`; `what` names the table in the message.
    void check_keys(const toml::table& table, std::string_view what, const std::vector<std::string>& known) const;
    /// A number as it was typed but without underscores, or the content of a string.
    std::string text_of(const toml::node& node) const;

    // Each of these returns a value of the wanted type and range, or throws InputError that says what `key` needs.
    std::string string(const toml::node& node, std::string_view key) const;
    double positive_number(const toml::node& node, std::string_view key) const;
    int whole_number(const toml::node& node, std::string_view key, int lower, int upper) const;
    const toml::array& filled_array(const toml::node& node, std::string_view key, std::string_view of_what) const;
    const toml::table& table(const toml::node& node, std::string_view key) const;

private:
    SourceLocation at(const toml::source_region& region) const;
    /// The text from a position up to the next delimiter.
    std::string typed_at(const toml::source_position& position) const;

    std::string file_;
    std::vector<std::string> lines_;
    toml::table root_;
};

}  // namespace gib
