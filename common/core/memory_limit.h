#pragma once
// Large requests for memory are refused here before they are made: a machine that overcommits grants every request
// and then kills the process.

#include "common/core/error.h"

#include <string>

namespace gib {

/// The bytes that this process can still take: the least of the system's available memory (MemAvailable) and of what
/// is left by the control groups above the process and by its own limits (RLIMIT_AS, RLIMIT_DATA). Infinite if none
/// of them is known.
double available_memory();

/// Throws InputError `WHAT needs N bytes, and M are available` if `bytes` is larger than available_memory().
void require_memory(double bytes, const std::string& what, const SourceLocation& where = {});

/// Throws the same error if the memory for `values` floats of an image of this size is not available.
void require_memory_for_image(double values, int width, int height, int channels, const SourceLocation& where);

}  // namespace gib
