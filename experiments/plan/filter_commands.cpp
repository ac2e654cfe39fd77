#include "experiments/plan/filter_commands.h"

#include "common/core/nearest_word.h"
#include "common/core/reject.h"
#include "experiments/plan/filter_label.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace gib {

namespace {

/// The name of the file that the command's first word gives, of characters that a label may have.
std::string program_of(const std::string& command) {
    const std::string word = command.substr(0, command.find_first_of(" \t\n"));
    std::string name = word.substr(word.rfind('/') + 1);
    std::erase_if(name, [](char c) { return std::string_view("{}='\"`,;$").find(c) != std::string_view::npos; });
    return name.empty() ? "command" : name;
}

}  // namespace

const std::vector<std::string>& filter_placeholders() {
    static const std::vector<std::string> names = {"image", "albedo", "normal", "depth", "variance", "threads", "out"};
    return names;
}

std::string FilterCommands::name_of(const TomlReader& reader, const toml::node& value) {
    const std::string text = reader.string(value, "filter");
    const SourceLocation where = reader.at(value);
    if (text == no_filter || text == non_local_means_filter) return text;
    const ExternalMethod command{.label = {}, .command = text, .where = where};
    for (const char* needed : {"image", "out"})
        if (!command.takes(needed))
            reject(where, "'filter' is {}, {} or a command with the placeholders {{image}} and {{out}}, not '{}'{}",
                   no_filter, non_local_means_filter, text,
                   did_you_mean(text, {std::string(no_filter), std::string(non_local_means_filter)}));
    for (const std::string& name : command.placeholders())
        if (const auto& known = filter_placeholders(); std::ranges::find(known, name) == known.end())
            reject(where, "the placeholder {{{}}} has no value: there are {}", name, fmt::join(known, ", "));
    for (int i = 1;; ++i) {
        const std::string name = program_of(text) + (i == 1 ? "" : fmt::format("-{}", i));
        const auto [entry, is_new] = commands_.try_emplace(name, command);
        if (is_new || entry->second.command == text) return name;
    }
}

}  // namespace gib
