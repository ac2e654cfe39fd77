#pragma once
// Each method at equal time: which of its stored images it shows of a scene by then, and how good it is.

#include "experiments/analysis/table_row.h"
#include "experiments/results/judgement.h"

#include <vector>

namespace gib {

/// The looks of all methods of one scene, as of one_label_a_method(). The seconds are Contest::equal_time(). A
/// method without an image by then has no error, and shows its first image. FLIP needs the images, which are read from the folder: a frame is compared at its own size, a
/// final image as in the tables.
std::vector<EqualTimeLook> equal_time_looks(const Analysis& analysis, const std::string& scene,
                                            const Judgement& judgement, const ResultFolder& folder);

}  // namespace gib
