#include "experiments/program/named_files.h"

#include "common/core/nearest_word.h"
#include "common/core/reject.h"
#include "common/images/image_file.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/system/build_info.h"

#include <algorithm>
#include <filesystem>

namespace gib {

namespace fs = std::filesystem;

namespace {

/// The names of the files in `folder` that end in `extension`, without it, in alphabetical order.
std::vector<std::string> names_in(const fs::path& folder, std::string_view extension) {
    std::vector<std::string> names;
    if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder))
            if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

/// `kind`: scene or experiment.
std::string file_or_shipped(const std::string& path_or_name, std::string_view kind, const std::string& extension) {
    if (fs::exists(path_or_name)) return path_or_name;
    const fs::path folder(shipped_folder(fmt::format("{}s", kind)));
    const auto names = names_in(folder, extension);
    if (std::ranges::find(names, path_or_name) != names.end()) return (folder / (path_or_name + extension)).string();
    const fs::path path(path_or_name);
    std::string nearest = did_you_mean(path.stem().string(), names);
    if (nearest.empty() && path.extension() == extension)
        nearest =
            did_you_mean(path.stem().string(), names_in(path.has_parent_path() ? path.parent_path() : ".", extension));
    throw InputError(fmt::format("{}: there is no such file, and no {} of that name (`gibench list {}s`){}",
                                 path_or_name, kind, kind, nearest));
}

}  // namespace

std::vector<std::string> shipped_scene_names() { return names_in(shipped_folder("scenes"), ".xml"); }

std::vector<std::string> shipped_experiment_names() { return names_in(shipped_folder("experiments"), ".toml"); }

std::string scene_file(const std::string& path_or_name) { return file_or_shipped(path_or_name, "scene", ".xml"); }

std::string experiment_file(const std::string& path_or_name) {
    return file_or_shipped(path_or_name, "experiment", ".toml");
}

void require_no_reference(const std::string& path) {
    const auto image = exr_attributes(path);
    if (image && !attribute_in(*image, "reference_key").empty())
        reject({path}, "this is a reference (of '{}' by '{}'), which `render` does not replace; give another -o",
               attribute_in(*image, "scene"), attribute_in(*image, "method"));
}

void require_own_reference(const std::string& path, const std::string& key) {
    const auto image = exr_attributes(path);
    if (!image) return;
    const auto replace = "give another -o, or --replace";
    if (attribute_in(*image, "reference_key").empty())
        reject({path}, "this is an image, but no reference, and would be lost; {}", replace);
    if (attribute_in(*image, "reference_key") != key)
        reject(
            {path},
            "this is the reference of another scene, scene file, method or seed ('{}' by '{}'), and would be lost; {}",
            attribute_in(*image, "scene"), attribute_in(*image, "method"), replace);
}

}  // namespace gib
