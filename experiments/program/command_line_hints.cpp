#include "experiments/program/command_line_hints.h"

#include "common/core/nearest_word.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <string_view>

namespace gib {

namespace {

std::vector<std::string> commands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({}))
        if (!command->get_group().empty()) names.push_back(command->get_name());
    return names;
}

std::vector<std::string> options_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const auto& name : option->get_lnames())
            names.push_back("--" + name);
    return names;
}

bool is_parameter(const std::string& name) {
    const auto has = [&](const std::vector<Parameter>& parameters) {
        return std::ranges::any_of(parameters, [&](const auto& p) { return p.name == name; });
    };
    const auto& methods = method_registry();
    return has(shared_parameters()) || std::ranges::any_of(methods, [&](const auto& m) { return has(m.parameters); });
}

/// Advice about a word that a command does not expect.
std::string advice(const CLI::App& command, const std::string& word) {
    const bool has_method = command.get_option_no_throw("--method") != nullptr;
    const std::string name = word.substr(0, word.find('='));
    if (has_method && word.find('=') != std::string::npos && is_parameter(name))
        return fmt::format("; a label stands in quotes: --method \"NAME {}\"", word);
    if (has_method && word.starts_with("--") && is_parameter(name.substr(2)))
        return fmt::format("; parameters stand in the label: --method \"NAME {}=...\"", name.substr(2));
    return word.starts_with("--") ? did_you_mean(name, options_of(command)) : "";
}

}  // namespace

std::string wrong_word(const CLI::App& app, const std::vector<std::string>& words) {
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty())
        command = command->get_subcommands().front();
    const auto known = commands_of(*command);
    const auto extras = command->remaining();
    // The words stand in their order on the command line, which the parser does not keep.
    const auto wrong = std::ranges::find_if(
        words, [&](const std::string& word) { return std::ranges::find(extras, word) != extras.end(); });
    const std::string path = command == &app ? "gibench" : "gibench " + command->get_name();
    if (!known.empty() && wrong == words.end())
        return fmt::format("{} needs a command; there are: {}", path, fmt::join(known, ", "));
    if (wrong == words.end()) return "";
    if (!known.empty() && !wrong->starts_with("-"))
        return fmt::format("{} has no command '{}'{} There are: {}", path, *wrong, did_you_mean_or_stop(*wrong, known),
                           fmt::join(known, ", "));
    return fmt::format("{}: '{}' is not expected{}", path, *wrong, advice(*command, *wrong));
}

void take_help_as_option(int argc, char** argv) {
    static char help[] = "--help";
    if (argc < 2 || std::string_view(argv[1]) != "help") return;
    std::rotate(argv + 1, argv + 2, argv + argc);
    argv[argc - 1] = help;
}

}  // namespace gib
