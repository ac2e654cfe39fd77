#pragma once
// The data of the report's charts as JSON: curves and spectra of each scene, by component.
//
// The report's section about a tuning, from the file `tune.json` that `gibench tune` leaves in its folder
// (tuning_result.h).

#include "experiments/analysis/analysis.h"
#include "experiments/results/result_folder.h"

#include <nlohmann/json.hpp>

namespace gib {

/// {"methods": [...], "targets": [...], "scenes": {NAME: {"components": [...],
/// "curves": {COMPONENT: [{"method": index, "stops": [passes, ...], "points": [[passes, seconds, relative RMSE, lo, hi, RMSE, lo, hi,
/// least passes of a seed], ...]}]}, "noise_floor": {COMPONENT: relative RMSE of the reference's noise},
/// "spectra": {COMPONENT: [{"method": index, "noise": [[frequency, power], ...], "bias": ...}]}}}}.
/// Errors are shares, not percent; lo and hi are null if there is no interval.
nlohmann::json report_data(const Analysis& analysis);

/// Adds the words to the page and the numbers of the charts to its data. Nothing, if the folder is that of no tuning.
void add_tuning(const ResultFolder& folder, nlohmann::json& page, nlohmann::json& numbers);

}  // namespace gib
