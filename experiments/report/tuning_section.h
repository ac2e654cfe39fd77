#pragma once
// The report's section about a tuning, from the file `tune.json` that `gibench tune` leaves in its folder (tuning_result.h).

#include "experiments/results/result_folder.h"

#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

namespace gib {

/// Adds the words to the page and the numbers of the charts to its data. Nothing, if the folder is that of no tuning.
void add_tuning(const ResultFolder& folder, kainjow::mustache::data& page, nlohmann::json& numbers);

}  // namespace gib
