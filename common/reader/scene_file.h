#pragma once
// Loading a scene from a Mitsuba 3 XML file.

#include "common/scene/scene.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace gib {

struct SceneLoadOptions {
    std::map<std::string, std::string> parameters;  ///< values of the file's $parameters (`--set`)
    std::optional<std::pair<int, int>> resolution;  ///< width and height instead of the film's
};

struct LoadedScene {
    std::string name;  ///< the file's name without folder and extension
    std::shared_ptr<const Scene> scene;
    std::optional<int> sample_count;  ///< of the file's sampler
    int max_edges;                    ///< of the file's integrator; INT_MAX: unlimited
    /// Of everything that the image depends on: XML, includes, meshes, parameters, resolution. 40 hexadecimal digits.
    std::string content_hash;
};

/// Of several sensors the first counts, as in Mitsuba.
/// Throws InputError (`file:line:column: message`) for anything wrong in the file or in what it refers to.
LoadedScene load_scene(const std::string& path, const SceneLoadOptions& options = {});

/// The same for XML in memory; `path` names it in messages and its folder is searched for files.
LoadedScene parse_scene(const std::string& xml, const std::string& path, const SceneLoadOptions& options = {});

}  // namespace gib
