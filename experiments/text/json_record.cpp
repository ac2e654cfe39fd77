#include "experiments/text/json_record.h"

#include "common/core/files.h"

namespace gib {

nlohmann::json read_json(const std::string& path) { return nlohmann::json::parse(read_file(path)); }

std::string json_digest(const nlohmann::json& record) {
    ContentHash hash;
    hash.add(record.dump());
    return hash.hex();
}

}  // namespace gib
