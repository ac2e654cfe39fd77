#pragma once
// The words beside the images of a scene's methods at equal time.

#include "experiments/analysis/table_row.h"

#include <string>
#include <vector>

namespace gib {

struct LookWords {
    EqualTimeLook look;
    std::string error;         ///< the relative RMSE [%], or why there is none
    std::string flip = {};     ///< may be empty
    std::string kind;          ///< error_kind()
    std::string missing = {};  ///< parts that the method leaves out; may be empty
    std::string energy = {};   ///< components whose mean energy differs from the reference's; may be empty
    std::string shown = {};    ///< which image of seed 1 it is, "16 passes, 0.41 s"
};

/// The words of every look of a scene, the smallest error first. Methods that leave out light come after those that
/// have all.
std::vector<LookWords> look_words(const Analysis& analysis, const std::string& scene);

}  // namespace gib
