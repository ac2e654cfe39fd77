#pragma once
// The words beside the images of a scene's methods at equal time.

#include "experiments/analysis/ranking.h"
#include "experiments/analysis/table_row.h"

#include <string>
#include <vector>

namespace gib {

struct LookWords {
    EqualTimeLook look;
    Standing standing;        ///< open where no method can be the best
    Field error;              ///< the relative RMSE [%], or why there is none
    std::string beside = {};  ///< "best", "tie with the best", ...; empty where no method can be the best
    Field flip = {};
    std::string kind;     ///< error_kind()
    std::string missing;  ///< left_out()
    std::string energy;   ///< layers whose mean energy differs from the reference's; may be empty
    std::string shown;    ///< which image of seed 1 it is, "16 passes, 0.41 s"
};

/// The images of a scene after `seconds`, in the order of Contest::after(): the smallest error first, methods that leave out
/// light after those that have all, those without an image last.
struct SceneLook {
    double seconds = 0;
    std::vector<LookWords> methods = {};
};
SceneLook scene_look(const Analysis& analysis, const std::string& scene);

}  // namespace gib
