#pragma once
// Says which word of the command line is wrong, and what was probably meant.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace gib {

/// A message about the first word that the program does not expect; empty if there is none. `words` are those of the
/// command line as typed, without the program's name. The parser has to have failed on them.
std::string wrong_word(const CLI::App& app, const std::vector<std::string>& words);

/// Makes `help run` of a command line `run --help`, as in other programs.
void take_help_as_option(int argc, char** argv);

}  // namespace gib
