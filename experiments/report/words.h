#pragma once
// Says in words what a method's error is made of, what the method leaves out, how it stands beside the best one, and what stands
// beside the images of a scene at equal time.

#include "experiments/analysis/ranking.h"
#include "experiments/analysis/table_row.h"

#include <string>
#include <vector>

namespace gib {

/// The light and the effects that a method leaves out, such as "refraction; light of direct, indirect".
std::string left_out(const TableRow& row);

/// Whether the error of the final images is bias or noise: "noise; bias below 16 % of the squared error", "bias: 63 % of
/// the squared error, 51 to 75". The shares are bias^2 and its 95 % interval, over bias^2 + variance. For a method that
/// is declared unbiased and leaves out nothing: "noise: the method is unbiased". Empty if the layer is not judged.
std::string error_kind(const TableRow& row);

/// "tie with `a`, `b`", "one seed does not tell", "not run longer: `c`"; empty if there are none.
std::string words_of(const Doubts& doubts);
/// The same about the best; empty if there is none.
std::string doubts(const std::vector<Contender>& ranking);

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
