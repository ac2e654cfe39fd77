#pragma once
// The page of a tuning: time over each parameter, the settings that cannot be told apart, halved and doubled settings.

#include "experiments/tuning/tuning_result.h"

#include <string>

namespace gib {

/// Writes `tune.html`, one file that opens offline, and `tune.json` with its numbers into a folder. Returns the page's path.
std::string write_tuning_page(const TuningResult& result, const std::string& folder);

/// The page.
std::string tuning_html(const TuningResult& result);
/// {"scene", "target", "target_error", "used_seconds", "methods": [label, ...], "best": {"method": index, "label", "paste",
/// "values": [text of each parameter, empty without effect], "seconds", "seconds_lo", "seconds_hi"} or null,
/// "tuned": [{"parameters": [{"name", "unit", "sentence", "words": [...] or null}], "settings": [{"label", "values",
/// "seconds": null if never, "measured": by the curve, not by its law}]}], "finals": [{"label", "standing"}], "notes": [...]}
std::string tuning_json(const TuningResult& result);

}  // namespace gib
