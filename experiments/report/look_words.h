#pragma once
// The words beside the images of a scene's methods at equal time.

#include "experiments/analysis/table_row.h"

#include <string>
#include <vector>

namespace gib {

struct LookWords {
    EqualTimeLook look;
    Field error;              ///< the relative RMSE [%], or why there is none
    std::string beside = {};  ///< "best", "tie with the best", ...; empty where no method can be the best
    bool is_best = false, is_tie = false;
    Field flip = {};
    std::string kind;          ///< error_kind()
    std::string missing = {};  ///< parts that the method leaves out; may be empty
    std::string energy = {};   ///< layers whose mean energy differs from the reference's; may be empty
    std::string shown = {};    ///< which image of seed 1 it is, "16 passes, 0.41 s"
};

/// The words of every look of a scene in the order of Contest::after(): the smallest error first, methods that leave out
/// light after those that have all, those without an image last.
std::vector<LookWords> look_words(const Analysis& analysis, const std::string& scene);

}  // namespace gib
