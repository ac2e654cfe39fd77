#include "experiments/program/help_format.h"

#include <CLI/CLI.hpp>

#include <sstream>

namespace gib {

namespace {

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

}  // namespace

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

}  // namespace gib
