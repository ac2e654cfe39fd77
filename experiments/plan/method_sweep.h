#pragma once
// Makes method labels from a [[method]] table of an experiment file, in which a parameter may have a list of values.

#include "experiments/plan/toml_reader.h"
#include "methods/method.h"

#include <string>
#include <vector>

namespace gib {

/// The most labels of a method. Lists of values multiply, so that a few lines could ask for more labels than
/// memory holds.
inline constexpr std::size_t most_combinations = 10000;

/// The checked labels of a table of parameters. One list of values makes a sweep, several make a grid, in which the
/// last list varies fastest.
class MethodSweep {
public:
    /// `start` is a label of the method, to which parameters are added.
    MethodSweep(const TomlReader& reader, const MethodDescription& method, MethodLabel start)
        : MethodSweep(reader, all_parameters(method), std::move(start)) {}
    /// A sweep of a name that is no method of gibench, with these parameters.
    MethodSweep(const TomlReader& reader, std::vector<Parameter> parameters, MethodLabel start);

    /// Adds a parameter with its value or its list of values.
    /// Throws InputError at the place of the key or of the value.
    void add(const TomlReader::Entry& entry);
    /// The label with these values in place of the entry's.
    void add(const TomlReader::Entry& entry, const std::vector<std::string>& values);
    /// The keys of a table that has these keys of its own besides the parameters.
    std::vector<std::string> keys_beside(std::vector<std::string> own) const;
    /// All labels, each after the method's own check, which sees its values together. Throws InputError at `where`.
    std::vector<MethodLabel> labels(const SourceLocation& where) const;
    /// All labels as they are, without that check.
    const std::vector<MethodLabel>& combinations() const { return labels_; }

private:
    std::string checked(const TomlReader::Entry& entry, const toml::node& value) const;

    const TomlReader& reader_;
    std::vector<Parameter> parameters_;
    std::vector<MethodLabel> labels_;
};

}  // namespace gib
