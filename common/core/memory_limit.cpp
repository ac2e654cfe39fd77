#include "common/core/memory_limit.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

namespace gib {

namespace {

namespace fs = std::filesystem;
constexpr double unlimited = std::numeric_limits<double>::infinity();

/// The number that follows a name in a file of lines `name: 123 kB`, in bytes. Empty if there is none.
std::optional<double> entry_in(const std::string& path, const std::string& name) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string first, unit;
        double value = 0;
        if (!(words >> first >> value) || (first != name && first != name + ":")) continue;
        return words >> unit && unit == "kB" ? value * 1024 : value;
    }
    return std::nullopt;
}

/// The number that is the content of a file. Empty if the file holds `max` (no limit) or does not exist.
std::optional<double> number_in(const fs::path& path) {
    std::ifstream file(path);
    double value = 0;
    return file >> value ? std::optional(value) : std::nullopt;
}

/// The bytes that a control group leaves: its limit less its use. Cached pages of files count as used, but the system
/// gives them up when memory is short, so that they are subtracted.
double left_in(const fs::path& group) {
    const auto limit = number_in(group / "memory.max");
    if (!limit) return unlimited;
    const double used = number_in(group / "memory.current").value_or(0);
    const double cached = entry_in((group / "memory.stat").string(), "inactive_file").value_or(0);
    return std::max(0.0, *limit - std::max(0.0, used - cached));
}

/// The minimum over the process's control group and all groups above it.
double left_by_groups() {
    constexpr std::string_view start = "0::";  // beginning of the line that names the group
    const fs::path root = "/sys/fs/cgroup";
    double least = left_in(root);
    std::ifstream file("/proc/self/cgroup");
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(start)) continue;
        fs::path folder = root;
        for (const auto& part : fs::path(line.substr(start.size())).relative_path()) {
            folder /= part;
            least = std::min(least, left_in(folder));
        }
    }
    return least;
}

/// The bytes that a limit of this process leaves: the limit less the memory that the process already has.
double left_by(int resource, const char* used_name) {
    rlimit limit{};
    if (::getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return unlimited;
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - entry_in("/proc/self/status", used_name).value_or(0));
}

}  // namespace

double available_memory() {
    return std::min({entry_in("/proc/meminfo", "MemAvailable").value_or(unlimited), left_by_groups(),
                     left_by(RLIMIT_AS, "VmSize"), left_by(RLIMIT_DATA, "VmData")});
}

void require_memory(double bytes, const std::string& what, const SourceLocation& where) {
    constexpr double always_there = 1 << 20;  // [bytes] too few to be worth asking the system
    if (bytes <= always_there) return;
    const double available = available_memory();
    if (bytes > available)
        throw InputError(where, fmt::format("{} needs {:.0f} bytes, and {:.0f} are available", what, bytes, available));
}

void require_memory_for_image(double values, int width, int height, int channels, const SourceLocation& where) {
    require_memory(values * sizeof(float),
                   fmt::format("an image of {} x {} pixels and {} channels", width, height, channels), where);
}

}  // namespace gib
