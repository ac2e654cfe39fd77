#pragma once
// Loads a scene from a Mitsuba 3 XML file.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

class Scene;

struct SceneLoadOptions {
    std::map<std::string, std::string> parameters;  ///< values of the file's $parameters (`--set`)
    std::optional<std::pair<int, int>> resolution;  ///< width and height instead of the film's
    std::vector<std::string> folders = {};          ///< searched for files after the scene's own, the first one first
};

struct LoadedScene {
    std::string name;  ///< the file's name without folder and extension
    std::shared_ptr<const Scene> scene;
    std::optional<int> sample_count;  ///< samples a pixel in the file's sampler; none: it gives no count
    int max_edges;                    ///< longest path of the file's integrator [edges]; INT_MAX: unlimited
    /// Hash of all bytes that were read: XML, includes, meshes, parameters, resolution. Results and references are stored under
    /// it. 40 hexadecimal digits.
    std::string content_hash;
    /// Hash of what is seen: two images of one size are comparable if their scenes have the same one. It covers the XML after
    /// includes and parameters, and all files. It does not cover comments, the sampler, the integrator but for `max_depth` and
    /// `hide_emitters`, and the film but for its filter and the part of it that a crop window shows. 40 hexadecimal digits.
    std::string view_hash;
    /// Messages about parts of the file that are changed, left out or likely to be mistakes, as `file:line:column: message`.
    std::vector<std::string> warnings;
};

/// Loads a scene. Of several sensors the first is used, as in Mitsuba. Throws InputError (`file:line:column:
/// message`) for anything wrong in the file or in what it refers to.
LoadedScene load_scene(const std::string& path, const SceneLoadOptions& options = {});

/// Loads a scene from XML in memory. `path` is its name in messages, and files are searched for in the
/// folder of `path`.
LoadedScene parse_scene(const std::string& xml, const std::string& path, const SceneLoadOptions& options = {});

}  // namespace gib
