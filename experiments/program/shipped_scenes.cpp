#include "experiments/program/shipped_scenes.h"

#include "common/core/reject.h"
#include "experiments/system/build_info.h"
#include "experiments/text/nearest_word.h"

#include <algorithm>
#include <filesystem>

namespace gib {

namespace fs = std::filesystem;

std::vector<std::string> shipped_scene_names() {
    std::vector<std::string> names;
    const fs::path folder(shipped_scenes_folder());
    if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder))
            if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::string scene_file(const std::string& path_or_name) {
    if (fs::exists(path_or_name)) return path_or_name;
    const auto names = shipped_scene_names();
    if (std::find(names.begin(), names.end(), path_or_name) != names.end())
        return (fs::path(shipped_scenes_folder()) / (path_or_name + ".xml")).string();
    const std::string stem = fs::path(path_or_name).stem().string();
    throw InputError({path_or_name}, "there is no such file, and no scene of that name (`gibench list scenes`)" +
                                         did_you_mean(stem, names));
}

}  // namespace gib
