#pragma once
// Reads the [[method]] tables of an experiment file: methods of gibench and commands of other renderers.

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

}  // namespace gib
