#pragma once
// Measurements as JSON, as a cell's process hands them over and as they are stored.

#include "experiments/measuring/measure.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// JSON has no NaN: null stands for it, both ways.
nlohmann::json number_to_json(double value);
double number_from_json(const nlohmann::json& j);

/// The whole number j[key] of the file at `path`; throws InputError where it is not from least to greatest.
int count_from_json(const nlohmann::json& j, const char* key, const std::string& path, int least, int greatest);
/// The same where the number is more than an int holds.
std::int64_t large_count_from_json(const nlohmann::json& j, const char* key, const std::string& path,
                                   std::int64_t least, std::int64_t greatest);

nlohmann::json checkpoint_to_json(const Checkpoint& checkpoint);
Checkpoint checkpoint_from_json(const nlohmann::json& j);
nlohmann::json stages_to_json(const std::vector<StageTimes::Stage>& stages);
std::vector<StageTimes::Stage> stages_from_json(const nlohmann::json& j);

}  // namespace gib
