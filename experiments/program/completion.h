#pragma once
// Makes the completion of the command line for bash.

#include <string>

namespace CLI {
class App;
}

namespace gib {

/// A script for bash that completes the commands and options that `app` knows, the methods after --method, and names of
/// shipped scenes and experiments beside files.
std::string bash_completion(const CLI::App& app);

}  // namespace gib
