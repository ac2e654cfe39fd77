#pragma once
// The text that `gibench tune` prints.

#include "experiments/tuning/tuning_result.h"

#include <string>

namespace gib {

/// The best label first, then its times, the other settings as factors, what is gained over the defaults and what was cut.
/// One of the settings has reached the target.
std::string tuning_text(const TuningResult& result);

/// The words for the time of a final setting beside the best one: "1.3 (1.1 to 1.5) times as long", "not reached in the final runs".
std::string standing_text(const TuningResult& result, const FinalSetting& other);

}  // namespace gib
