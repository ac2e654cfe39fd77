#pragma once
// What this program was built from and with.

#include <string>
#include <utility>
#include <vector>

namespace gib {

/// "gibench 0.1.0".
std::string program_version();

struct BuildInfo {
    std::string commit;  ///< of git, "unknown" outside a repository
    bool modified;       ///< files differed from that commit
    std::string compiler;
    std::string flags;
    std::string build_type;
    std::vector<std::pair<std::string, std::string>> libraries;  ///< name, version
};
const BuildInfo& build_info();

/// Where the scenes that come with the program are.
std::string shipped_scenes_folder();

/// SHA-1 of the running program's file: cells of different builds are not silently mixed.
std::string executable_hash();

}  // namespace gib
