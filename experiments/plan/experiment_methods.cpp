#include "experiments/plan/experiment_methods.h"

#include "common/core/nearest_word.h"
#include "common/core/reject.h"
#include "experiments/plan/experiment_keys.h"
#include "experiments/plan/label_checks.h"
#include "experiments/plan/method_sweep.h"
#include "methods/method.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

namespace gib {

namespace {

using Commands = std::map<std::string, ExternalMethod>;

bool is_one_of(std::string_view word, const std::vector<std::string>& words) {
    return std::ranges::find(words, word) != words.end();
}

/// The key `label` of a table; empty if it is not given.
std::string read_given_name(const TomlReader& reader, const toml::table& table, std::set<std::string>& names) {
    const auto* node = table.get("label");
    if (!node) return "";
    const std::string name = reader.string(*node, "label");
    if (name.find_first_of("\n\r\t`") != std::string::npos)
        throw InputError(reader.at(*node), "a label has one line, and no backquotes");
    if (!names.insert(name).second) reject(reader.at(*node), "two methods have the label '{}'", name);
    return name;
}

/// The first word of a command; blanks between quotes or after a backslash belong to it, as in a shell.
std::string first_word(const std::string& command) {
    std::string word;
    char quote = '\0';
    for (std::size_t i = command.find_first_not_of(" \t\n"); i < command.size(); ++i) {
        const char c = command[i];
        if (c == '\\' && quote != '\'' && i + 1 < command.size()) word += command[++i];
        else if (c == quote) quote = '\0';
        else if (quote == '\0' && (c == '\'' || c == '"')) quote = c;
        else if (quote == '\0' && std::string_view(" \t\n").find(c) != std::string_view::npos) break;
        else word += c;
    }
    return word;
}

/// The name of the file that the command's first word gives, of characters that a label may have.
std::string program_of(const std::string& command) {
    const std::string word = first_word(command);
    std::string name = word.substr(word.rfind('/') + 1);
    std::erase_if(name, [](char c) { return std::string_view("{}='\"`,;$\\").find(c) != std::string_view::npos; });
    std::ranges::replace_if(
        name, [](char c) { return std::string_view(" \t\n").find(c) != std::string_view::npos; }, '_');
    return name.empty() ? "command" : name;
}

/// The name in labels of a value of the key `filter`, which may be a command such as that of Open Image Denoise: the
/// file's name of its first word, and a number if several commands have the same. Adds commands to `filters`.
std::string read_filter(const TomlReader& reader, const toml::node& value, Commands& filters) {
    static const std::vector<std::string> known = {"image", "albedo", "normal", "depth", "variance", "threads", "out"};
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
        if (!is_one_of(name, known))
            reject(where, "the placeholder {{{}}} has no value: there are {}", name, fmt::join(known, ", "));
    for (int i = 1;; ++i) {
        const std::string name = program_of(text) + (i == 1 ? "" : fmt::format("-{}", i));
        const auto [entry, is_new] = filters.try_emplace(name, command);
        if (is_new || entry->second.command == text) return name;
    }
}

/// The names of the values of the key `filter`.
std::vector<std::string> read_filters(const TomlReader& reader, const toml::table& table, Commands& filters) {
    const auto* node = table.get("filter");
    if (!node) return {};
    const auto* list = node->as_array();
    if (!list) return {read_filter(reader, *node, filters)};
    std::vector<std::string> names;
    for (const auto& value : reader.filled_array(*list, "filter", "values"))
        names.push_back(read_filter(reader, value, filters));
    return names;
}

/// Throws InputError if the label's filter takes two halves of the passes and there are none.
void require_halves(const MethodLabel& label, const Commands& filters, const SourceLocation& where) {
    const auto command = filters.find(filter_of(label));
    if (command == filters.end()) require_own_filter(label, where);
    else if (command->second.takes("variance")) require_passes(label, 2, where);
}

std::string read_choice(const TomlReader& reader, const toml::node& node, const std::string& key,
                        const std::vector<std::string>& choices) {
    const std::string word = reader.string(node, key);
    if (!is_one_of(word, choices))
        reject(reader.at(node), "'{}' cannot be '{}'; it is one of: {}", key, word, fmt::join(choices, ", "));
    return word;
}

/// The name of the rows, which no method of gibench may have.
std::string read_name(const TomlReader& reader, const toml::node& node) {
    const std::string name = reader.string(node, "name");
    const MethodLabel label = MethodLabel::parse(name, reader.at(node));
    const auto& registry = method_registry();
    if (label.name != name) reject(reader.at(node), "the name of a method with a command is one word, not '{}'", name);
    if (name == auto_reference ||
        std::ranges::any_of(registry, [&](const auto& method) { return method.name == name; }))
        reject(reader.at(node), "'{}' is a method of gibench; a method with a command needs another name", name);
    return name;
}

/// The labels of a table, one for each combination of the values of `spp` and of the placeholders that are its own.
std::vector<MethodLabel> read_labels(const TomlReader& reader, const toml::table& table, const std::string& name,
                                     const std::vector<std::string>& placeholders) {
    const auto settings = names_of(experiment_keys(), "[[method]] with a command");
    std::vector<Parameter> parameters;
    for (const Parameter& shared : shared_parameters())
        if (shared.name == "spp" && is_one_of("spp", placeholders)) parameters.push_back(shared);
    for (const std::string& placeholder : placeholders)
        if (!is_one_of(placeholder, command_placeholders()) && !is_one_of(placeholder, settings))
            parameters.push_back(
                {.name = placeholder, .kind = Parameter::Kind::text, .default_value = "", .unit = "", .sentence = ""});
    MethodSweep sweep(reader, parameters, MethodLabel{name, {}});
    for (const auto& entry : reader.entries(table)) {
        if (is_one_of(entry.key, settings)) continue;
        if (entry.key == "spp" && !is_one_of("spp", placeholders))
            reject(entry.key_at, "'spp' has no effect: the command lacks the placeholder {{spp}}");
        if (!is_one_of(entry.key, names_of(parameters)))
            reject(entry.key_at,
                   "unknown key '{}' in a [[method]] with a command{} There are: {}, and the names in braces in "
                   "its command ({})",
                   entry.key, help_with_key(entry.key, settings), fmt::join(settings, ", "),
                   fmt::join(placeholders, ", "));
        sweep.add(entry);
    }
    return sweep.combinations();
}

/// Reads a [[method]] table that has a `command`. A list of values makes a sweep. Throws InputError at its place for a
/// name that a method of gibench has, a placeholder without a value, a key that is no placeholder, and a command that
/// lacks {scene} or {out}.
std::vector<ExternalMethod> read_external_method(const TomlReader& reader, const toml::table& table,
                                                 const SourceLocation& where) {
    const auto* name = table.get("name");
    if (!name) throw InputError(where, "a [[method]] needs a 'name'");
    const toml::node& node = *table.get("command");
    ExternalMethod method{
        .label = {read_name(reader, *name), {}}, .command = reader.string(node, "command"), .where = reader.at(node)};
    const auto placeholders = method.placeholders();
    for (const char* needed : {"scene", "out"})
        if (!is_one_of(needed, placeholders))
            reject(method.where, "a command needs the placeholder {{{}}}; all are: {}", needed,
                   fmt::join(command_placeholders(), ", "));
    for (const std::string& placeholder : placeholders)
        if (!is_one_of(placeholder, command_placeholders()) && !table.get(placeholder))
            reject(method.where, "the placeholder {{{}}} has no value: there are {}, and keys of this [[method]]",
                   placeholder, fmt::join(command_placeholders(), ", "));
    if (const auto* format = table.get("image_format"))
        method.image_format = read_choice(reader, *format, "image_format", {"exr", "pfm", "hdr"});
    if (const auto* timeout = table.get("timeout")) method.timeout = reader.positive_number(*timeout, "timeout");
    std::vector<ExternalMethod> methods;
    for (MethodLabel& label : read_labels(reader, table, method.label.name, placeholders)) {
        if (MethodLabel::parse(label.text(), where).values != label.values)
            reject(where, "'{}' cannot be the label of a method: its values have no spaces", label.text());
        methods.push_back(method);
        for (const auto& [key, value] : label.values)
            if (key == "spp")
                methods.back().spp =
                    static_cast<std::uint32_t>(ParameterValues(shared_parameters(), {"", {{key, value}}}).integer(key));
        methods.back().label = std::move(label);
    }
    return methods;
}

}  // namespace

ExperimentMethods read_methods(const TomlReader& reader, const toml::node& node) {
    ExperimentMethods methods;
    std::set<std::string> texts, names;
    for (const auto& item : reader.filled_array(node, "method", "[[method]] tables")) {
        const auto& table = reader.table(item, "method");
        const SourceLocation where = reader.at(item);
        const std::string given_name = read_given_name(reader, table, names);
        const auto add = [&](const MethodLabel& label) {
            if (!texts.insert(label.text()).second) reject(where, "the method '{}' is listed twice", label.text());
            methods.methods.push_back(label);
            if (!given_name.empty()) methods.given_names[label.text()] = given_name;
        };
        if (table.get("command")) {
            for (ExternalMethod& external : read_external_method(reader, table, where)) {
                add(external.label);
                methods.externals.emplace(external.label.text(), std::move(external));
            }
            continue;
        }
        const std::vector<std::string> filter_names = read_filters(reader, table, methods.filters);
        const auto* name = table.get("name");
        if (!name) throw InputError(where, "a [[method]] needs a 'name'");
        const auto& description = find_comparable_method(reader.string(*name, "name"), reader.at(*name));
        MethodSweep sweep(reader, description, MethodLabel{description.name, {}});
        reader.check_keys(table, fmt::format("a [[method]] '{}'", description.name),
                          sweep.keys_beside(names_of(experiment_keys(), "[[method]]")));
        for (const auto& entry : reader.entries(table))
            if (entry.key == "filter") sweep.add(entry, filter_names);
            else if (entry.key != "name" && entry.key != "label") sweep.add(entry);
        for (const auto& label : sweep.labels(where)) {
            require_halves(label, methods.filters, where);
            add(label);
        }
    }
    return methods;
}

}  // namespace gib
