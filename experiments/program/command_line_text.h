#pragma once
// The words of the command line: texts of options that mean more than a number, help that fits a terminal of 80
// columns, which word is wrong, and the completion for bash.

#include "experiments/plan/run_options.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Formatter;
}  // namespace CLI

namespace gib {

/// A message about the first word that the program does not expect; empty if there is none. `words` are those of the
/// command line as typed, without the program's name. The parser has to have failed on them.
std::string wrong_word(const CLI::App& app, const std::vector<std::string>& words);

/// Makes `help run` of a command line `run --help`, as in other programs.
void take_help_as_option(int argc, char** argv);

/// The text in lines of at most `width` characters, broken at spaces; a line that begins with spaces goes on below
/// them. Words that are longer stand alone.
std::string wrapped(const std::string& text, std::size_t width);

/// For CLI::App::formatter().
std::shared_ptr<CLI::Formatter> narrow_help();

/// A script for bash that completes the commands and options that `app` knows, the methods after --method, and names of
/// shipped scenes and experiments beside files.
std::string bash_completion(const CLI::App& app);

/// The values of --set NAME=VALUE, by name.
std::map<std::string, std::string> assignments(const std::vector<std::string>& texts);
/// The width and height of --resolution, such as 640x480.
std::pair<int, int> resolution_in(const std::string& text);
/// The share of --share, such as 0/4.
RunShare share_in(const std::string& text);

}  // namespace gib
