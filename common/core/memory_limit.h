#pragma once
// Memory that a request takes, refused before it is taken: a machine that overcommits grants every request and then
// kills the process.

#include "common/core/error.h"

#include <string>

namespace gib {

/// Bytes that this process can still take: the least of what the system has (MemAvailable), what the control groups
/// above it leave, and its own limits (RLIMIT_AS, RLIMIT_DATA). Infinite where nothing says so.
double available_memory();

/// The first two alone; `proc` and `control_groups` are where the system keeps them, /proc and /sys/fs/cgroup.
double available_memory(const std::string& proc, const std::string& control_groups);

/// Throws InputError `WHAT needs N bytes, and M are available` if more is needed than there is.
void require_memory(double bytes, const std::string& what, const SourceLocation& where = {});

/// The same of `values` floats of an image.
void require_memory_for_image(double values, int width, int height, int channels, const SourceLocation& where);

}  // namespace gib
