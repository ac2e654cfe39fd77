#pragma once
// The error-against-time curves of stored cells, and their means over the seeds.

#include "experiments/analysis/table_row.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The names of the scenes, in the order of the cells.
std::vector<std::string> scenes_of(const Analysis& analysis);
/// The names of a scene's components that are judged, in the order of its rows; `total` is one of them.
std::vector<std::string> components_of(const Analysis& analysis, const std::string& scene);

using CellsByMethod = std::map<std::string, std::vector<const Cell*>>;
/// The cells of a scene that have an image, by method label.
CellsByMethod cells_by_method(const Analysis& analysis, const std::string& scene);

/// The mean of the runs' total times [s].
double mean_seconds(const std::vector<const Cell*>& cells);

/// The relative squared error of one run after `seconds` of charged time, with the reference's own variance
/// subtracted. Between two checkpoints it follows a power law of time; after the last one it stays constant. Empty
/// before the first image.
std::optional<double> error2_after(const Cell& cell, const std::string& component, double seconds);
/// The mean of error2_after() over runs, unclipped. Empty unless all runs have an image by then.
std::optional<double> mean_error2_after(const std::vector<const Cell*>& cells, const std::string& component,
                                        double seconds);
/// The same, but that of the final images if the runs' mean total time is not above `seconds`, although some of them are
/// not complete by then.
std::optional<double> mean_error2_by(const std::vector<const Cell*>& cells, const std::string& component,
                                     double seconds);
/// The square root of mean_error2_by(). Empty where this mean is not above `noise_floor`, the relative squared
/// error that is lost in the reference's own noise.
std::optional<double> relative_rmse_after(const std::vector<const Cell*>& cells, const std::string& component,
                                          double seconds, double noise_floor);

/// The number of checkpoints, from the first on, that all runs have after the same passes. Runs may differ in their
/// later ones, because a time budget ends them after different numbers of passes.
std::size_t common_checkpoints(const std::vector<const Cell*>& cells);

}  // namespace gib
