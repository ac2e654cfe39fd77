#include "experiments/text/json_record.h"

#include "common/core/files.h"

namespace gib {

nlohmann::json read_json(const std::string& path) { return nlohmann::json::parse(read_file(path)); }

static std::string digest_of(const nlohmann::json& record) {
    ContentHash hash;
    hash.add(record.dump());
    return hash.hex();
}

void write_sealed_json(const std::string& path, nlohmann::json record) {
    record["digest"] = digest_of(record);
    write_file(path, record.dump(1) + "\n");
}

nlohmann::json read_sealed_json(const std::string& path) {
    nlohmann::json record = read_json(path);
    const std::string digest = record.at("digest");
    record.erase("digest");
    if (digest != digest_of(record)) return nullptr;
    return record;
}

}  // namespace gib
