#include "experiments/measuring/measurement_json.h"

#include "common/core/error.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace gib {

using nlohmann::json;

json number_to_json(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

double number_from_json(const json& j) {
    return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}

int count_from_json(const json& j, const char* key, const std::string& path, int least, int greatest) {
    return static_cast<int>(large_count_from_json(j, key, path, least, greatest));
}

std::int64_t large_count_from_json(const json& j, const char* key, const std::string& path, std::int64_t least,
                                   std::int64_t greatest) {
    const json& value = j.at(key);
    if (value.is_number_integer()) {
        const auto number = value.get<double>();  // a double, because the number may exceed an int64_t
        if (number >= static_cast<double>(least) && number <= static_cast<double>(greatest)) return value;
    }
    throw InputError({path},
                     fmt::format("'{}' is no whole number from {} to {}: {}", key, least, greatest, value.dump()));
}

json checkpoint_to_json(const Checkpoint& c) {
    const NonFinite& bad = c.counts.non_finite;
    return {{"passes", c.passes},
            {"seconds", c.seconds},
            {"photons", c.counts.photons},
            {"rays", c.counts.rays},
            {"nonfinite", {{"count", bad.count}, {"first_pass", bad.first_pass}, {"first_pixel", bad.first_pixel}}},
            {"peak_rss_mib", c.peak_rss_mib}};
}

Checkpoint checkpoint_from_json(const json& j) {
    Checkpoint c;
    c.passes = j.at("passes");
    c.seconds = j.at("seconds");
    c.counts.photons = j.at("photons");
    c.counts.rays = j.at("rays");
    const json& bad = j.at("nonfinite");
    c.counts.non_finite = {bad.at("count"), bad.at("first_pass"), bad.at("first_pixel")};
    c.peak_rss_mib = j.at("peak_rss_mib");
    return c;
}

json stages_to_json(const std::vector<StageTimes::Stage>& stages) {
    json list = json::array();
    for (const auto& stage : stages)
        list.push_back({{"stage", stage.name}, {"seconds", stage.seconds}});
    return list;
}

std::vector<StageTimes::Stage> stages_from_json(const json& j) {
    std::vector<StageTimes::Stage> stages;
    for (const auto& stage : j)
        stages.push_back({stage.at("stage"), stage.at("seconds")});
    return stages;
}

}  // namespace gib
