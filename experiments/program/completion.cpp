#include "experiments/program/completion.h"

#include "experiments/program/shipped_files.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <vector>

namespace gib {

namespace {

/// The parts of the script that depend on the program: the commands, each with those above it, and what may follow each of them.
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

}  // namespace gib
