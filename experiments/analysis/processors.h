#pragma once
// Whether the seconds of a scene's cells compare: they do if one processor measured all of them and nothing else kept it
// busy.

#include "experiments/analysis/curves.h"

#include <set>
#include <string>
#include <vector>

namespace gib {

/// The names of the processors of these cells; records of older versions have none.
std::set<std::string> processors_of(const Runs& cells);

/// A warning that names the processors of a scene's cells and the methods that each one has measured; empty if all are
/// alike.
std::optional<Warning> unlike_processors(const std::vector<Cell>& cells, const std::string& scene);

/// A warning that names the methods of a scene whose cells had to wait for a processor, or whose seeds took unlike times
/// for a pass, and the command that measures them again (`experiment_file` is empty for a tuning). Empty if there are none.
std::optional<Warning> busy_machine(const Analysis& analysis, const std::string& scene,
                                    const std::string& experiment_file);

}  // namespace gib
