#pragma once
// Finds the files that come with the program, in the folders of the build or where they were installed.

#include <filesystem>
#include <string>
#include <system_error>

namespace gib {

/// The path of a file or folder that comes with the program: `installed`, which is relative to the folder of the
/// running program, if it exists, so that an installation may be moved; else `built`, its place at build time.
inline std::string program_file(const std::string& installed, const std::string& built) {
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    const auto path = (program.parent_path() / installed).lexically_normal();
    return !error && std::filesystem::exists(path, error) ? path.string() : built;
}

}  // namespace gib
