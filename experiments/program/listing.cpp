// `gibench list`: prints methods, scenes, effects, keys and columns from their declarations.

#include "common/scene/effects.h"
#include "experiments/plan/experiment_keys.h"
#include "experiments/program/commands.h"
#include "experiments/report/tables.h"
#include "experiments/system/build_info.h"
#include "experiments/system/shipped_files.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <ostream>

namespace gib {

namespace {

std::string parameter_lines(const std::vector<Parameter>& parameters) {
    std::string text;
    for (const auto& p : parameters) {
        std::string facts = range_of(p);
        if (!p.unit.empty()) facts = p.unit + "; " + facts;
        if (!p.default_value.empty()) facts += "; default " + p.default_value;
        if (p.tuning && p.kind == Parameter::Kind::choice) facts += "; tune searches these words";
        else if (p.tuning) facts += fmt::format("; tune searches {:g} to {:g}", p.tuning->lower, p.tuning->upper);
        text += fmt::format("  {:<16} {} ({})\n", p.name, p.sentence, facts);
    }
    return text;
}

std::string plain_text_of(const std::vector<DeclaredTable>& tables) {
    std::string text;
    for (const auto& table : tables) {
        text += fmt::format("{:<28} {}\n", table.name, table.sentence);
        for (const auto& [name, value, sentence] : table.entries)
            text += fmt::format("  {:<22} {}{}\n", name, sentence, value.empty() ? "" : " (" + value + ")");
        if (!table.others.empty()) text += fmt::format("  {:<22} {}\n", "any other key", table.others);
    }
    return text;
}

/// `head` is the title with its text, `columns` the headings of names and values.
std::string markdown_of(const std::vector<DeclaredTable>& tables, const std::string& head, const char* columns) {
    std::string text = head;
    for (const auto& table : tables) {
        text += fmt::format("\n## {}\n\n{}{}.\n\n| {} | meaning |\n|---|---|---|\n", table.name,
                            static_cast<char>(std::toupper(table.sentence[0])), table.sentence.substr(1), columns);
        for (const auto& [name, value, sentence] : table.entries)
            text += fmt::format("| `{}` | {} | {} |\n", name, value, sentence);
        if (!table.others.empty()) text += fmt::format("\nAny other key is {}.\n", table.others);
    }
    return text;
}

constexpr const char* key_head = R"(# Keys of experiment files

An experiment file is TOML; [the manual](README.md#write-an-experiment) says how to write one. A key that is not named here is an error that lists the known ones. `gibench list keys` prints this list, `gibench list columns` the columns below. This page is made by the program: `(gibench list keys --markdown; gibench list columns --markdown) > experiments/REFERENCE.md`.
)";

constexpr const char* column_head = R"(
# Columns of the CSV files

An empty field is undefined or was never reached; it is not zero. [The manual](README.md#read-the-table) explains the tables that are made of them.
)";

/// Removes the marks of Markdown tables, lists and code from a line.
std::string plain_text(std::string line) {
    line.erase(std::remove(line.begin(), line.end(), '`'), line.end());
    const std::size_t begin = line.find_first_not_of(" |*-:\t");
    if (begin == std::string::npos) return "";
    line = line.substr(begin);
    for (std::size_t bar; (bar = line.find(" | ")) != std::string::npos;)
        line.replace(bar, 3, "; ");
    line.erase(line.find_last_not_of(" |*\t") + 1);
    return line;
}

/// The text after the file's name on the first line of the scenes' README that contains the name; else empty.
std::string sentence_about(const std::string& file_name, const std::string& readme) {
    std::ifstream stream(readme);
    for (std::string line; std::getline(stream, line);) {
        const std::size_t at = line.find(file_name);
        if (at != std::string::npos) return plain_text(line.substr(at + file_name.size()));
    }
    return "";
}

/// The title of an experiment file; empty if it has none.
std::string title_of(const std::string& experiment) {
    std::ifstream stream(experiment);
    for (std::string line; std::getline(stream, line);)
        if (line.starts_with("title = \"")) return line.substr(9, line.rfind('"') - 9);
    return "";
}

}  // namespace

void list_methods(bool parameters, std::ostream& out) {
    for (const auto& method : method_registry()) {
        out << fmt::format("{:<28} {}\n", method.name, method.sentence);
        if (parameters) out << parameter_lines(method.parameters);
    }
    if (parameters) out << "every method\n" << parameter_lines(shared_parameters());
}

void list_scenes(std::ostream& out) {
    const std::string readme = shipped_folder("scenes") + "/README.md";
    for (const std::string& stem : shipped_scene_names()) {
        const std::string sentence = sentence_about(stem + ".xml", readme);
        out << (sentence.empty() ? stem : fmt::format("{:<28} {}", stem, sentence)) << "\n";
    }
}

void list_experiments(std::ostream& out) {
    for (const std::string& name : shipped_experiment_names())
        out << fmt::format("{:<28} {}\n", name, title_of(experiment_file(name)));
}

void list_effects(std::ostream& out) {
    for (const auto& effect : effect_descriptions())
        out << fmt::format("{:<28} {}\n", effect.name, effect.sentence);
}

void list_keys(bool markdown, std::ostream& out) {
    out << (markdown ? markdown_of(experiment_keys(), key_head, "key | value") : key_help());
}

void list_columns(bool markdown, std::ostream& out) {
    out << (markdown ? markdown_of(csv_files(), column_head, "column | unit") : plain_text_of(csv_files()));
}

std::string key_help() { return plain_text_of(experiment_keys()); }

std::string parameter_help() {
    std::string text;
    for (const auto& method : method_registry())
        text += fmt::format("{}: {}\n{}", method.name, method.sentence, parameter_lines(method.parameters));
    return text + "every method:\n" + parameter_lines(shared_parameters());
}

}  // namespace gib
