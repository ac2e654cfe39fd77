#include "experiments/slurm/log_pattern.h"

#include "common/core/reject.h"

namespace gib {

std::string log_pattern(const std::string& path) {
    std::string pattern;
    for (const char c : path) {
        if (c == '\\') reject({path, 0, 0}, "Slurm writes no logs to a path with a backslash");
        if (c == '%') pattern += '%';
        pattern += c;
    }
    return pattern;
}

}  // namespace gib
