#pragma once
// Converts measurements to JSON and back: a cell's process hands them over as JSON, and they are stored as JSON.

#include "experiments/measuring/measure.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// JSON has neither NaN nor infinity: values that are not finite are written as null, and null is read as NaN.
nlohmann::json number_to_json(double value);
double number_from_json(const nlohmann::json& j);

/// The whole number j[key] of the file at `path`. Throws InputError unless it lies in [least, greatest].
int count_from_json(const nlohmann::json& j, const char* key, const std::string& path, int least, int greatest);
/// Does the same as count_from_json() for numbers that an int cannot hold.
std::int64_t large_count_from_json(const nlohmann::json& j, const char* key, const std::string& path,
                                   std::int64_t least, std::int64_t greatest);

nlohmann::json checkpoint_to_json(const Checkpoint& checkpoint);
Checkpoint checkpoint_from_json(const nlohmann::json& j);
nlohmann::json stages_to_json(const std::vector<StageTimes::Stage>& stages);
std::vector<StageTimes::Stage> stages_from_json(const nlohmann::json& j);

}  // namespace gib
