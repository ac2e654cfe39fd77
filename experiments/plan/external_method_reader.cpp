#include "experiments/plan/external_method_reader.h"

#include "common/core/reject.h"
#include "experiments/plan/experiment_keys.h"
#include "experiments/plan/method_sweep.h"
#include "experiments/plan/reference_methods.h"
#include "methods/method.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace gib {

namespace {

bool is_one_of(std::string_view word, const std::vector<std::string>& words) {
    return std::ranges::find(words, word) != words.end();
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
                   "unknown key '{}' in a [[method]] with a command; there are: {}, and the names in braces in "
                   "its command ({})",
                   entry.key, fmt::join(settings, ", "), fmt::join(placeholders, ", "));
        sweep.add(entry);
    }
    return sweep.combinations();
}

/// Throws InputError unless every value of the label is read back as it was written.
void require_label(const MethodLabel& label, const SourceLocation& where) {
    if (MethodLabel::parse(label.text(), where).values != label.values)
        reject(where, "'{}' cannot be the label of a method: its values have no spaces", label.text());
}

}  // namespace

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
    if (const auto* format = table.get("scene_format"))
        method.scene_format = read_choice(reader, *format, "scene_format", {"mitsuba", "povray"}) == "povray"
                                  ? SceneFormat::povray
                                  : SceneFormat::mitsuba;
    if (const auto* format = table.get("image_format"))
        method.image_format = read_choice(reader, *format, "image_format", {"exr", "pfm", "hdr"});
    if (const auto* timeout = table.get("timeout")) method.timeout = reader.positive_number(*timeout, "timeout");
    std::vector<ExternalMethod> methods;
    for (MethodLabel& label : read_labels(reader, table, method.label.name, placeholders)) {
        require_label(label, where);
        methods.push_back(method);
        for (const auto& [key, value] : label.values)
            if (key == "spp")
                methods.back().spp =
                    static_cast<std::uint32_t>(ParameterValues(shared_parameters(), {"", {{key, value}}}).integer(key));
        methods.back().label = std::move(label);
    }
    return methods;
}

}  // namespace gib
