#pragma once
// What the report's charts draw, as JSON: curves and spectra of each scene, by component.

#include "experiments/analysis/analysis.h"

#include <nlohmann/json.hpp>

#include <string>

namespace gib {

/// {"methods": [...], "epsilon": ..., "targets": [...], "scenes": {NAME: {"components": [...],
/// "curves": {COMPONENT: [{"method": index, "points": [[passes, seconds, relative RMSE, lo, hi, RMSE, lo, hi], ...]}]},
/// "noise_floor": {COMPONENT: relative RMSE that the reference resolves},
/// "spectra": {COMPONENT: [{"method": index, "noise": [[frequency, power], ...], "bias": ...}]}}}}.
/// Errors are shares, not percent; null where there is no interval.
nlohmann::json report_data(const Analysis& analysis);

}  // namespace gib
