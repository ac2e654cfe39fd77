#pragma once
// Scene files made on the spot, for the tests of the scene reader.

#include "common/core/files.h"
#include "common/reader/scene_file.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <atomic>
#include <filesystem>
#include <string>

namespace gib::test {

/// A new temporary folder, which the destructor removes with its content.
class TemporaryFolder {
public:
    TemporaryFolder() {
        static std::atomic<int> counter = 0;
        path_ = std::filesystem::path(::testing::TempDir()) /
                ("gib-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    /// The path of a file in the folder.
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    /// Writes a file, creating the folders it needs, and returns its path.
    std::string write(const std::string& name, const std::string& content) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        write_file((path_ / name).string(), content);
        return (path_ / name).string();
    }

private:
    std::filesystem::path path_;
};

inline const std::string sensor_xml =
    "<sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/><film type=\"hdrfilm\"><integer name=\"width\" "
    "value=\"4\"/><integer name=\"height\" value=\"4\"/><rfilter type=\"box\"/></film></sensor>\n";

/// A scene with a sensor on line 1 and `body` from line 2.
inline std::string scene_with(const std::string& body) {
    return "<scene version=\"3.0.0\">" + sensor_xml + body + "</scene>\n";
}

inline LoadedScene load(const std::string& body, const SceneLoadOptions& options = {}) {
    return parse_scene(scene_with(body), "test.xml", options);
}

/// The scene of `body`, whose files are in `folder`.
inline LoadedScene load_in(const TemporaryFolder& folder, const std::string& body) {
    return parse_scene(scene_with(body), folder / "s.xml");
}

}  // namespace gib::test
