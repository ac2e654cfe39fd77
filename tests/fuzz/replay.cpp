// Feeds files to a target in builds without libFuzzer: gib_fuzz_NAME FILE_OR_FOLDER... The exit code is 1 if a file
// is a finding or there is no file.

#include "common/core/files.h"
#include "tests/fuzz/harness.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <vector>

namespace {

std::vector<std::string> files_of(const std::filesystem::path& path) {
    if (!std::filesystem::is_directory(path)) return {path.string()};
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(path))
        files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

int main(int argc, char** argv) {
    int inputs = 0, findings = 0;
    for (int i = 1; i < argc; ++i)
        for (const auto& file : files_of(argv[i])) {
            try {
                ++inputs;
                gib::fuzz::run_input(gib::read_file(file));
            } catch (const std::exception& error) {
                std::printf("%s: %s\n", file.c_str(), error.what());
                ++findings;
            }
        }
    std::printf("%d inputs, %d findings\n", inputs, findings);
    // An empty or missing folder tests nothing, so it counts as a failure.
    return findings > 0 || inputs == 0 ? 1 : 0;
}
