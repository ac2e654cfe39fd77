#include "experiments/json_file.h"

#include "common/error.h"
#include "common/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gib {

namespace {

constexpr int deepest = 64;  // ours have 5 levels at most

}  // namespace

nlohmann::json read_json(const std::string& path) {
    using nlohmann::json;
    return json::parse(read_file(path), [&](int depth, json::parse_event_t, const json&) {
        if (depth > deepest) throw InputError({path}, fmt::format("nested more than {} levels deep", deepest));
        return true;
    });
}

}  // namespace gib
