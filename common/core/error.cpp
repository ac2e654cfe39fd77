#include "common/core/error.h"

namespace gib {

std::string format_location(const SourceLocation& where, const std::string& message) {
    if (where.file.empty()) return message;
    // Every message about a file has the same three-part prefix, so that editors and scripts can parse it.
    return where.file + ":" + std::to_string(std::max(where.line, 1)) + ":" +
           std::to_string(std::max(where.column, 1)) + ": " + message;
}

}  // namespace gib
