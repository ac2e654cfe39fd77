#pragma once
// Quantities that change the meaning of the numbers of a scene, not its images. Numbers of two runs are compared only
// if all of it is alike: `gibench compare-runs`, `--repeat`, and gibench.unlike() in Python, which reads the list from
// manifest.json.

#include "experiments/results/result_folder.h"

#include <map>
#include <string>
#include <vector>

namespace gib {

/// Values as text, by the names of the quantities.
using Quantities = std::map<std::string, std::string>;

/// `unjudged`: lit components that are no part of the total, because the reference lacks them.
Quantities quantities_of(const ResultIndex& index, const IndexScene& scene, const Components& unjudged);

/// The quantities in which two runs differ: "epsilon was 0.1 and is 0.001"; empty if there is none. Those that only one
/// of them knows, as older versions wrote fewer, are left out.
struct Differences {
    std::string all;      ///< no number compares
    std::string seconds;  ///< no time compares
    std::string noted;    ///< numbers compare, but are known less well in one of the runs
};
Differences differences(const Quantities& before, const Quantities& after);

}  // namespace gib
