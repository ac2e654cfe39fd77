#include "experiments/system/shipped_files.h"

#include "common/core/error.h"
#include "common/core/nearest_word.h"
#include "experiments/system/build_info.h"

#include <fmt/format.h>

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

/// The file of this name in the folder of a kind, scene or experiment; empty if there is none.
std::string shipped_file(const std::string& name, std::string_view kind, const std::string& extension) {
    const fs::path folder(shipped_folder(fmt::format("{}s", kind)));
    const auto names = names_in(folder, extension);
    return std::ranges::find(names, name) == names.end() ? "" : (folder / (name + extension)).string();
}

std::string file_or_shipped(const std::string& path_or_name, std::string_view kind, const std::string& extension) {
    if (fs::exists(path_or_name)) return path_or_name;
    if (const std::string file = shipped_file(path_or_name, kind, extension); !file.empty()) return file;
    const auto names = names_in(shipped_folder(fmt::format("{}s", kind)), extension);
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

std::string shipped_scene(const std::string& name) { return shipped_file(name, "scene", ".xml"); }

std::string scene_file(const std::string& path_or_name) { return file_or_shipped(path_or_name, "scene", ".xml"); }

std::string experiment_file(const std::string& path_or_name) {
    return file_or_shipped(path_or_name, "experiment", ".toml");
}

}  // namespace gib
