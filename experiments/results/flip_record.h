#pragma once
// The FLIP of a complete cell, kept beside its image: measured once, after all cells are timed, never charged.

#include "common/images/image.h"
#include "experiments/results/result_folder.h"

#include <optional>
#include <string>

namespace gib {

/// HDR-FLIP of a cell's final image against the reference, its mean over the pixels. The first call stores it as
/// flip.json, and the map as flip_map(), in the cell's folder; later ones measure it again if either file was damaged
/// or is about other images. Empty if either has values that are not finite. Throws
/// InputError if sizes differ.
std::optional<double> cell_flip(const ResultFolder& folder, const std::string& cell_name, const Image& total,
                                const Image& r_total);

/// Before a cell is done again.
void forget_flip(const ResultFolder& folder, const std::string& cell_name);

}  // namespace gib
