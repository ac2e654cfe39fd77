#include "experiments/measuring/measurement_json.h"

#include "common/core/reject.h"

namespace gib {

std::int64_t count_from_json(const nlohmann::json& j, const char* key, const std::string& path, std::int64_t least,
                             std::int64_t greatest) {
    const nlohmann::json& value = j.at(key);
    if (value.is_number_integer()) {
        const auto number = value.get<double>();  // a double, because the number may exceed an int64_t
        if (number >= static_cast<double>(least) && number <= static_cast<double>(greatest)) return value;
    }
    reject({path}, "'{}' is no whole number from {} to {}: {}", key, least, greatest, value.dump());
}

}  // namespace gib
