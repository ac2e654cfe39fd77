#pragma once
// The error-against-time curves of stored cells, and their means over the seeds.

#include "experiments/analysis/table_row.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// Names, in the order of the cells.
std::vector<std::string> scenes_of(const Analysis& analysis);
/// Names of components that a scene's rows have and that are judged, in their order; `total` is one.
std::vector<std::string> components_of(const Analysis& analysis, const std::string& scene);

using CellsByMethod = std::map<std::string, std::vector<const Cell*>>;
/// Those of a scene that have an image, by label.
CellsByMethod cells_by_method(const Analysis& analysis, const std::string& scene);

/// Relative squared error of one run `seconds` after its start, the reference's own variance subtracted. Between two
/// checkpoints it follows a power law of time. Empty before the first image; after the last one the error stays.
std::optional<double> error2_after(const Cell& cell, const std::string& component, double seconds);
/// The mean over runs; unclipped. Empty unless all have an image by then.
std::optional<double> mean_error2_after(const std::vector<const Cell*>& cells, const std::string& component,
                                        double seconds);
/// Its root; empty where it is not above `noise_floor`: below what the reference resolves.
std::optional<double> relative_rmse_after(const std::vector<const Cell*>& cells, const std::string& component,
                                          double seconds, double noise_floor);

/// How many checkpoints, from the first on, all runs have after the same passes: a budget of time ends runs after
/// different ones.
std::size_t common_checkpoints(const std::vector<const Cell*>& cells);

}  // namespace gib
