#pragma once
// Reads the [[method]] tables of an experiment file that have a command.

#include "experiments/plan/external_method.h"
#include "experiments/plan/toml_reader.h"

#include <vector>

namespace gib {

/// Reads a [[method]] table that has a `command`. A list of values makes a sweep. Throws InputError at its place for a
/// name that a method of gibench has, a placeholder without a value, a key that is no placeholder, and a command that
/// lacks {scene} or {out}.
std::vector<ExternalMethod> read_external_method(const TomlReader& reader, const toml::table& table,
                                                 const SourceLocation& where);

}  // namespace gib
