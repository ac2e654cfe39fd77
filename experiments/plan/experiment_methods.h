#pragma once
// Reads the [[method]] tables of an experiment file: methods of gibench and commands of other renderers.

#include "experiments/plan/external_method.h"
#include "experiments/plan/toml_reader.h"

namespace gib {

/// All labels of an experiment's [[method]] tables. Throws InputError for a method that is unknown, estimates no
/// radiance or is listed twice.
ExperimentMethods read_methods(const TomlReader& reader, const toml::node& node);

}  // namespace gib
