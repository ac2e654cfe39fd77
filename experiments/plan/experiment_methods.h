#pragma once
// Reads the [[method]] tables of an experiment file: methods of gibench and commands of other renderers.
// Reads the [[method]] tables of an experiment file that have a command.
//
// Filters that are commands, such as Open Image Denoise: values of the key `filter` of an experiment file.

#include "experiments/plan/external_method.h"
#include "experiments/plan/toml_reader.h"
#include "methods/parameters.h"

#include <map>
#include <string>
#include <vector>

namespace gib {

/// The methods of an experiment.
struct ExperimentMethods {
    std::vector<MethodLabel> labels;                  ///< in the order of the file
    std::map<std::string, ExternalMethod> externals;  ///< those with a command, by their labels
    std::map<std::string, ExternalMethod> filters;    ///< commands that filter, by their names in labels
    std::map<std::string, std::string> given_names;   ///< the key `label` of their tables, by their labels
};

/// All labels of an experiment's [[method]] tables. Throws InputError for a method that is unknown, estimates no
/// radiance or is listed twice.
ExperimentMethods read_methods(const TomlReader& reader, const toml::node& node);

/// Reads a [[method]] table that has a `command`. A list of values makes a sweep. Throws InputError at its place for a
/// name that a method of gibench has, a placeholder without a value, a key that is no placeholder, and a command that
/// lacks {scene} or {out}.
std::vector<ExternalMethod> read_external_method(const TomlReader& reader, const toml::table& table,
                                                 const SourceLocation& where);

/// The placeholders that a filter's command may have: image, albedo, normal, depth, variance, threads, out.
const std::vector<std::string>& filter_placeholders();

/// The commands of an experiment by the names that stand in labels: the file's name of the command's first word, and a number if
/// several commands have the same.
class FilterCommands {
public:
    /// The name of one value of the key. Throws InputError for what is neither a filter nor a command with {image} and {out}.
    std::string name_of(const TomlReader& reader, const toml::node& value);
    const std::map<std::string, ExternalMethod>& all() const { return commands_; }

private:
    std::map<std::string, ExternalMethod> commands_;
};

}  // namespace gib
