#include "experiments/results/flip_record.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "experiments/metrics/flip.h"
#include "experiments/results/color_maps.h"
#include "experiments/text/json_file.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace gib {

using nlohmann::json;

namespace {

std::string record_path(const ResultFolder& folder, const std::string& cell_name) {
    return folder.cell_folder(cell_name) + "/flip.json";
}

/// The facts in a record beside the value: digests of its two images and of the map's file. The last is null if there
/// is no map, because there is no value.
json facts_of(const Image& total, const Image& r_total, const std::string& map) {
    return {{"image", image_digest({{{"", total}}, {}})},
            {"reference", image_digest({{{"", r_total}}, {}})},
            {"map", std::filesystem::exists(map) ? json(file_hash(map)) : json(nullptr)}};
}

bool is_flip(const json& value) {
    return value.is_null() || (value.is_number() && value.get<double>() >= 0 && value.get<double>() <= 1);
}

/// The stored record. Null if there is none, if it or the map is damaged, or if it is not about these images.
json stored_record(const std::string& path, const Image& total, const Image& r_total, const std::string& map) {
    if (!std::filesystem::exists(path)) return nullptr;
    try {
        json record = read_json(path);
        const std::string digest = record.at("digest");
        record.erase("digest");
        if (digest != json_digest(record) || !is_flip(record.at("flip"))) return nullptr;
        const json facts = facts_of(total, r_total, map);
        for (const auto& [name, fact] : facts.items())
            if (record.at(name) != fact) return nullptr;
        return record;
    } catch (const json::exception&) {
        return nullptr;
    } catch (const InputError&) {
        return nullptr;
    }
}

/// Measures FLIP and writes its map. Empty, and nothing is written, if an image is not finite.
std::optional<double> measure_flip(const Image& total, const Image& r_total, const std::string& map_file) {
    if (total.non_finite_values() + r_total.non_finite_values() > 0) return std::nullopt;
    const FlipMap map = hdr_flip(total, r_total);
    const auto png = encode_png(flip_image(map), 1.f);
    write_file(map_file, {reinterpret_cast<const char*>(png.data()), png.size()});
    return map.mean();
}

}  // namespace

std::optional<double> cell_flip(const ResultFolder& folder, const std::string& cell_name, const Image& total,
                                const Image& r_total) {
    const std::string path = record_path(folder, cell_name), map = folder.flip_map(cell_name);
    json record = stored_record(path, total, r_total, map);
    if (record.is_null()) {
        forget_flip(folder, cell_name);
        const auto flip = measure_flip(total, r_total, map);
        record = facts_of(total, r_total, map);
        record["flip"] = flip ? json(*flip) : json(nullptr);
        record["digest"] = json_digest(record);
        // The record is written last, so that a record implies a complete map.
        write_file(path, record.dump(1) + "\n");
    }
    const json& flip = record["flip"];
    return flip.is_number() ? std::optional(flip.get<double>()) : std::nullopt;
}

void forget_flip(const ResultFolder& folder, const std::string& cell_name) {
    std::filesystem::remove(record_path(folder, cell_name));
    std::filesystem::remove(folder.flip_map(cell_name));
}

}  // namespace gib
