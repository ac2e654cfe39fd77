#pragma once
// The error-against-time curves of stored cells, and their means over the seeds.

#include "experiments/analysis/table_row.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

using Runs = std::vector<const Cell*>;

/// The names of the scenes, in the order of the cells.
std::vector<std::string> scenes_of(const Analysis& analysis);
/// The layers of a scene that the reference has, in the order of its rows.
std::vector<Layer> layers_of(const Analysis& analysis, const std::string& scene);

/// The analysis with the passes of each checkpoint in place of its seconds, so that Contest compares methods after
/// equal passes. Its laws and looks are still those of time.
Analysis with_passes_for_seconds(Analysis analysis);

using CellsByMethod = std::map<std::string, Runs>;
/// The cells of a scene that have an image, by method label.
CellsByMethod cells_by_method(const Analysis& analysis, const std::string& scene);

/// The mean of the runs' total times [s].
double mean_seconds(const Runs& cells);
/// The first time at which all runs have an image.
double first_image_of_all(const Runs& cells);
/// Whether more time would not change the images of these runs.
bool have_converged(const Runs& cells);
/// The runs without one of them.
Runs without(Runs cells, std::size_t left_out);

/// The relative squared error of one run after `seconds` of charged time, with the reference's own variance
/// subtracted. Between two checkpoints it follows a power law of time; after the last one it stays constant. Empty
/// before the first image.
std::optional<double> error2_after(const Cell& cell, Layer layer, double seconds);
/// error2_after() of each run. If the runs' mean total time is at most `seconds`, those of the final images. Empty
/// unless all runs have an image at that time.
std::vector<double> errors2_by(const Runs& cells, Layer layer, double seconds);

/// The mean of a method's runs at one point of their curves.
struct MeanPoint {
    std::uint32_t least_passes = 0, most_passes = 0;  ///< different only where a time budget ended the runs
    double seconds = 0;                               ///< mean over the runs
    std::vector<double> run_seconds = {}, relative = {},
                        absolute = {};  ///< by run: time, squared errors less the reference's variance
};
/// The points at the checkpoints that all runs have after the same passes, and the final images: a time budget ends
/// runs after different numbers of passes. Empty if a run has no errors of this layer.
std::vector<MeanPoint> mean_curve(const Runs& cells, Layer layer);

}  // namespace gib
