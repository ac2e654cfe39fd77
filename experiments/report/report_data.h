#pragma once
// The data of the report's charts as JSON: curves and spectra of each scene, by component.

#include "experiments/analysis/analysis.h"

#include <nlohmann/json.hpp>

#include <string>

namespace gib {

/// {"methods": [...], "targets": [...], "scenes": {NAME: {"components": [...],
/// "curves": {COMPONENT: [{"method": index, "stops": [passes, ...], "points": [[passes, seconds, relative RMSE, lo, hi, RMSE, lo, hi,
/// least passes of a seed], ...]}]}, "noise_floor": {COMPONENT: relative RMSE that the reference resolves},
/// "spectra": {COMPONENT: [{"method": index, "noise": [[frequency, power], ...], "bias": ...}]}}}}.
/// Errors are shares, not percent; lo and hi are null if there is no interval.
nlohmann::json report_data(const Analysis& analysis);

}  // namespace gib
