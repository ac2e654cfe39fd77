#pragma once
// The commit, the compiler, the flags and the libraries that this program was built with, and the processor.

#include <string>
#include <utility>
#include <vector>

namespace gib {

/// Name and version, as in "gibench 0.1.0".
std::string program_version();

/// Name and version, then the facts of build_info(), one a line; for `gibench --version`.
std::string build_text();

struct BuildInfo {
    std::string commit;  ///< hash of git's commit, "unknown" outside a repository
    bool modified;       ///< whether files differed from that commit
    std::string compiler;
    std::string flags;
    std::string build_type;
    std::vector<std::pair<std::string, std::string>> libraries;  ///< name, version
};
const BuildInfo& build_info();

/// The folder of the files that come with the program; `name`: scenes or experiments.
std::string shipped_folder(const std::string& name);

/// SHA-1 of the running program's file, so that cells of different builds are not silently mixed.
std::string executable_hash();

/// The processor's name as the system gives it.
std::string cpu_model();

}  // namespace gib
