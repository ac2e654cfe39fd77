#include "experiments/flip_record.h"

#include "common/error.h"
#include "common/files.h"
#include "common/image_file.h"
#include "experiments/flip.h"
#include "experiments/json_file.h"
#include "experiments/report_images.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace gib {

using nlohmann::json;

namespace {

std::string record_path(const ResultFolder& folder, const std::string& cell_name) {
    return folder.cell_folder(cell_name) + "/flip.json";
}

/// Null if there is none, or if it cannot be read.
json stored_record(const std::string& path) {
    if (!std::filesystem::exists(path)) return nullptr;
    try {
        json record = read_json(path);
        return record.is_object() && record.contains("flip") ? record : json(nullptr);
    } catch (const json::exception&) {
        return nullptr;
    } catch (const InputError&) {
        return nullptr;
    }
}

bool all_finite(const Image& image) {
    return std::all_of(image.rgb.begin(), image.rgb.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

std::optional<double> cell_flip(const ResultFolder& folder, const std::string& cell_name, const Image& total,
                                const Image& r_total) {
    const std::string path = record_path(folder, cell_name);
    json record = stored_record(path);
    if (record.is_null()) {
        record = {{"flip", nullptr}};
        if (all_finite(total) && all_finite(r_total)) {
            const FlipMap map = hdr_flip(total, r_total);
            const auto png = encode_png(flip_image(map), 1.f);
            write_file(folder.flip_map(cell_name), {reinterpret_cast<const char*>(png.data()), png.size()});
            record["flip"] = map.mean();
        }
        // The record comes last: where it stands, the map is whole.
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
