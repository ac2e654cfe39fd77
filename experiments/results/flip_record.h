#pragma once
// The FLIP of a complete cell, which is kept beside its image. It is measured once, after all cells are timed, and
// its time is never charged.

#include "common/images/image.h"
#include "experiments/results/result_folder.h"

#include <optional>
#include <string>

namespace gib {

/// HDR-FLIP of a cell's final image against the reference, mean over the pixels. Empty if either image has values
/// that are not finite. The first call stores the value as flip.json and the map as flip_map() in the cell's folder.
/// Later calls return it, and measure again if either file is damaged or belongs to other images. Throws InputError
/// if sizes differ.
std::optional<double> cell_flip(const ResultFolder& folder, const std::string& cell_name, const Image& total,
                                const Image& r_total);

/// Deletes the stored FLIP of a cell before the cell is measured again.
void forget_flip(const ResultFolder& folder, const std::string& cell_name);

}  // namespace gib
