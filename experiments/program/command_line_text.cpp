#include "experiments/program/command_line_text.h"

#include "common/core/nearest_word.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "experiments/system/shipped_files.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <sstream>
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
        return fmt::format("; put a label in quotes: --method \"NAME {}\"", word);
    if (has_method && word.starts_with("--") && is_parameter(name.substr(2)))
        return fmt::format("; parameters belong in the label: --method \"NAME {}=...\"", name.substr(2));
    return word.starts_with("--") ? did_you_mean(name, options_of(command)) : "";
}

constexpr std::size_t terminal_columns = 80;

class NarrowHelp : public CLI::Formatter {
public:
    std::string make_option(const CLI::Option* option, bool is_positional) const override {
        constexpr std::size_t indent = 6;
        std::string name =
            wrapped(make_option_name(option, is_positional) + make_option_opts(option), terminal_columns - indent);
        for (std::size_t at = 0; (at = name.find('\n', at)) != std::string::npos; at += indent)
            name.insert(at + 1, indent, ' ');
        std::stringstream out;
        CLI::detail::format_help(out, name, make_option_desc(option), get_column_width());
        return out.str();
    }
    std::string make_option_desc(const CLI::Option* option) const override {
        return wrapped(CLI::Formatter::make_option_desc(option), terminal_columns - get_column_width());
    }
    std::string make_subcommand(const CLI::App* command) const override {
        std::stringstream out;
        CLI::detail::format_help(out, command->get_name(),
                                 wrapped(command->get_description(), terminal_columns - get_column_width()),
                                 get_column_width());
        return out.str();
    }
    std::string make_description(const CLI::App* app) const override {
        return wrapped(CLI::Formatter::make_description(app), terminal_columns);
    }
    std::string make_footer(const CLI::App* app) const override {
        return wrapped(CLI::Formatter::make_footer(app), terminal_columns);
    }
};

/// The parts of the script that depend on the program: the commands, each with those above it, and what may follow each
/// of them.
struct KnownCommands {
    std::vector<std::string> names;
    std::string cases;  ///< of bash's `case`
};

/// Adds a command and all below it; `name` has the commands above it, too.
void add_command(const CLI::App& command, const std::string& name, KnownCommands& known) {
    std::vector<std::string> words, options, with_value;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty()) continue;  // internal
        std::vector<std::string> spellings;
        for (const auto& letter : option->get_snames())
            spellings.push_back("-" + letter);
        for (const auto& word : option->get_lnames())
            spellings.push_back("--" + word);
        options.insert(options.end(), spellings.begin(), spellings.end());
        if (option->get_items_expected_max() > 0)
            with_value.insert(with_value.end(), spellings.begin(), spellings.end());
        if (option->get_name(true) == "SCENE") words = shipped_scene_names();
        if (option->get_name(true) == "EXPERIMENT") words = shipped_experiment_names();
    }
    const bool has_files = !words.empty();
    for (const CLI::App* below : command.get_subcommands({})) {
        if (below->get_group().empty()) continue;  // internal
        words.push_back(below->get_name());
        known.names.push_back("'" + name + " " + below->get_name() + "'");
        add_command(*below, known.names.back().substr(1, known.names.back().size() - 2), known);
    }
    known.cases +=
        fmt::format("        '{}') words='{}' options='{}' with_value='{}' files={} ;;\n", name, fmt::join(words, " "),
                    fmt::join(options, " "), fmt::join(with_value, " "), has_files ? "yes" : "");
}

}  // namespace

std::string wrong_word(const CLI::App& app, const std::vector<std::string>& words) {
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty())
        command = command->get_subcommands().front();
    const auto known = commands_of(*command);
    const auto extras = command->remaining();
    // The words in their order on the command line, which the parser does not keep.
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

std::string wrapped(const std::string& text, std::size_t width) {
    std::string result;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
        const std::string indent(first == 0 ? 0 : first + 2, ' ');
        std::size_t used = first;
        std::string done(first, ' ');
        std::istringstream words(line);
        bool begins = true;
        for (std::string word; words >> word; begins = false) {
            if (!begins && used + 1 + word.size() > width) {
                done += "\n" + indent;
                used = indent.size();
                begins = true;
            }
            done += (begins ? "" : " ") + word;
            used += (begins ? 0 : 1) + word.size();
        }
        // Columns of a table keep their spaces where the line is short enough.
        result += (line.size() <= width ? line : done) + "\n";
    }
    if (!result.empty() && (text.empty() || text.back() != '\n')) result.pop_back();
    return result;
}

std::shared_ptr<CLI::Formatter> narrow_help() { return std::make_shared<NarrowHelp>(); }

std::string bash_completion(const CLI::App& app) {
    KnownCommands known;
    add_command(app, "gibench", known);
    std::vector<std::string> methods;
    for (const auto& method : method_registry())
        methods.push_back(method.name);
    // Where nothing matches, `complete -o default` completes files.
    return fmt::format(R"(# Completion of gibench for bash: source <(gibench completion bash)
_gibench() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command=gibench
    local word words options with_value files
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        case "$command $word" in
            {}) command+=" $word" ;;
        esac
    done
    case $command in
{}    esac
    if [[ $previous == --method ]]; then
        words='{}' files=
    elif [[ " $with_value " == *" $previous "* ]]; then
        words= files=
    elif [[ $current == -* ]]; then
        words=$options files=
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current"; [[ -z $files ]] || compgen -f -- "$current")
    [[ -z $files ]] || compopt -o filenames 2>/dev/null
}}
complete -o bashdefault -o default -F _gibench gibench
)",
                       fmt::join(known.names, "|"), known.cases, fmt::join(methods, " "));
}

std::map<std::string, std::string> assignments(const std::vector<std::string>& texts) {
    std::map<std::string, std::string> values;
    for (const auto& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) reject({}, "--set needs NAME=VALUE, not '{}'", text);
        if (!values.emplace(text.substr(0, equals), text.substr(equals + 1)).second)
            reject({}, "--set gives '{}' twice", text.substr(0, equals));
    }
    return values;
}

std::pair<int, int> resolution_in(const std::string& text) {
    const std::size_t x = text.find('x');
    const auto size_of = [&](const std::string& part) {
        const auto size = number_from<int>(part);
        return size && *size >= 1 && *size <= most_pixels_across ? *size : 0;
    };
    const int width = size_of(text.substr(0, x)), height = x == std::string::npos ? 0 : size_of(text.substr(x + 1));
    if (width == 0 || height == 0)
        reject({}, "--resolution needs WIDTHxHEIGHT, such as 640x480, two numbers from 1 to {}, not '{}'",
               most_pixels_across, text);
    return {width, height};
}

RunShare share_in(const std::string& text) {
    const std::size_t slash = text.find('/');
    const auto index = number_from<std::size_t>(text.substr(0, slash));
    const auto count = slash == std::string::npos ? std::nullopt : number_from<std::size_t>(text.substr(slash + 1));
    if (!index || !count || *index >= *count)
        reject({}, "--share needs I/N with I from 0 to N - 1, such as 0/4, not '{}'", text);
    return {*index, *count};
}

}  // namespace gib
