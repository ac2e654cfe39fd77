#pragma once
// The processors that measured a scene's cells. Their seconds compare only if they are alike.

#include "experiments/results/result_folder.h"

#include <string>
#include <vector>

namespace gib {

/// The names of the processors of these cells, each once, separated by `;`; empty if no record has one.
std::string processors_of(const std::vector<const Cell*>& cells);

/// A sentence, without its full stop, that names the processors of a scene's cells and the methods that each one has
/// measured; empty if all are alike.
std::string unlike_processors(const std::vector<Cell>& cells, const std::string& scene);

}  // namespace gib
