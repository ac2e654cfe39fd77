#pragma once
// The one exception type for wrong input: a message with the place that caused it. main() prints it and exits with
// code 2.

#include <stdexcept>
#include <string>

namespace gib {

/// A place in a file; line and column count from 1, 0 means "the whole file". An empty file means "no file" (the
/// command line).
struct SourceLocation {
    std::string file;
    int line = 0;
    int column = 0;
};

/// `file:line:column: message`, with the parts that are known.
std::string format_location(const SourceLocation& where, const std::string& message);

/// Wrong input: a file, an experiment, an option. what() is `file:line:column: message`.
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
