#pragma once
// Refuses input with a message that is put together from its parts.

#include "common/core/error.h"

#include <fmt/format.h>

namespace gib {

/// Throws InputError at `where`, which is {} for input from the command line.
template <typename... Args>
[[noreturn]] void reject(const SourceLocation& where, fmt::format_string<Args...> message, Args&&... args) {
    throw InputError(where, fmt::format(message, std::forward<Args>(args)...));
}

}  // namespace gib
