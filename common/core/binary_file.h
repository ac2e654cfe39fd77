#pragma once
// The place of errors in files that have no lines.

#include "common/core/error.h"

#include <string>
#include <utility>

namespace gib {

/// The place of an error in a file that is no text, such as an image. Messages have the form `file: message`.
inline SourceLocation binary_file(std::string file) { return {std::move(file), -1, -1}; }

}  // namespace gib
