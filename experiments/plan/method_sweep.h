#pragma once
// [[method]] tables: labels from parameters, some of which are lists.

#include "experiments/plan/toml_reader.h"
#include "methods/method.h"

#include <string>
#include <vector>

namespace gib {

/// Lists of values multiply: a few lines could ask for more combinations than memory holds.
inline constexpr std::size_t most_combinations = 10000;

/// The checked label of a table of parameters; each list of values makes a sweep, several a grid (the last varies
/// fastest).
class MethodSweep {
public:
    MethodSweep(const TomlReader& reader, const MethodDescription& method);

    /// A parameter with its value or its list of values. Throws InputError at its place.
    void add(const TomlReader::Entry& entry);
    /// Every label once through the method's own check, which sees the values together. Throws InputError at `where`.
    std::vector<MethodLabel> labels(const SourceLocation& where) const;

private:
    std::string checked(const TomlReader::Entry& entry, const toml::node& value) const;

    const TomlReader& reader_;
    const MethodDescription& method_;
    std::vector<Parameter> parameters_;
    std::vector<MethodLabel> labels_;
};

/// All labels of an experiment's [[method]] tables, in the order of the file. Throws InputError for a method that is
/// unknown, estimates no radiance or is listed twice.
std::vector<MethodLabel> read_methods(const TomlReader& reader, const toml::node& node);

}  // namespace gib
