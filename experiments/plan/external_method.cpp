#include "experiments/plan/external_method.h"

#include "common/core/reject.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace gib {

namespace {

/// The command with each placeholder replaced by what `value_of` returns. A placeholder is a name of small letters and
/// underscores in braces; the shell's ${NAME} is none.
std::string replaced(const std::string& command, const std::function<std::string(const std::string&)>& value_of) {
    std::string result;
    std::size_t at = 0;
    while (at < command.size()) {
        const std::size_t end =
            command[at] == '{' ? command.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", at + 1) : std::string::npos;
        const bool is_placeholder =
            end != std::string::npos && command[end] == '}' && end > at + 1 && (at == 0 || command[at - 1] != '$');
        if (is_placeholder) result += value_of(command.substr(at + 1, end - at - 1));
        else result += command[at];
        at = is_placeholder ? end + 1 : at + 1;
    }
    return result;
}

/// The word as a POSIX shell reads it back. Words of plain characters stay as they are.
std::string shell_word(const std::string& word) {
    const auto is_plain = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
               std::string_view("_-+=./,:@%").find(c) != std::string_view::npos;
    };
    if (!word.empty() && std::ranges::all_of(word, is_plain)) return word;
    std::string quoted = "'";
    for (const char c : word)
        quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

}  // namespace

const std::vector<std::string>& command_placeholders() {
    static const std::vector<std::string> names = {"scene", "out",     "spp",   "seconds",
                                                   "seed",  "threads", "width", "height"};
    return names;
}

std::vector<std::string> ExternalMethod::placeholders() const {
    std::vector<std::string> names;
    replaced(command, [&](const std::string& name) {
        names.push_back(name);
        return "";
    });
    return names;
}

bool ExternalMethod::takes(std::string_view placeholder) const {
    const auto names = placeholders();
    return std::ranges::find(names, placeholder) != names.end();
}

std::string ExternalMethod::identity() const {
    return fmt::format("mitsuba {} {}", image_format, command);  // so that cells of older versions stay valid
}

std::string filled_command(const ExternalMethod& method, const std::map<std::string, std::string>& values) {
    return replaced(method.command, [&](const std::string& name) {
        if (const auto value = values.find(name); value != values.end()) return shell_word(value->second);
        for (const auto& [key, value] : method.label.values)
            if (key == name) return shell_word(value);
        reject(method.where, "the placeholder {{{}}} has no value in this run", name);
    });
}

}  // namespace gib
