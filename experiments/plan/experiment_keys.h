#pragma once
// The keys of experiment files.

#include "experiments/text/declared.h"

namespace gib {

/// The tables of an experiment file, in the order in which a user meets them.
const std::vector<DeclaredTable>& experiment_keys();

/// The help for an unknown key of a table such as [[method]]: its place above all tables, if it is a key of the whole
/// file; else the known key that was probably meant. Ends with a full stop or a question mark.
std::string help_with_key(const std::string& key, const std::vector<std::string>& known);

}  // namespace gib
