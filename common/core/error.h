#pragma once
// The exceptions of the bench. InputError stands for wrong input and holds the place that caused it: main() prints it
// and exits with code 2. RunError stands for a run that could not be completed: exit code 1.

#include <stdexcept>
#include <string>

namespace gib {

/// A place in a file. Line and column count from 1; 0 stands for the whole file. An empty file name stands for input
/// from the command line.
struct SourceLocation {
    std::string file;
    int line = 0;
    int column = 0;
};

/// Returns `file:line:column: message`, or only `message` if there is no file. An unknown line or column is
/// printed as 1.
std::string format_location(const SourceLocation& where, const std::string& message);

/// Wrong input in a file, an experiment or an option. what() is `file:line:column: message`.
class InputError : public std::runtime_error {
public:
    explicit InputError(const std::string& message) : std::runtime_error(message) {}
    InputError(const SourceLocation& where, const std::string& message)
        : std::runtime_error(format_location(where, message)) {}
};

/// A run that could not be completed (exit code 1): out of memory, a full disk, a child process that died.
class RunError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace gib
