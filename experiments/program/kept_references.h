#pragma once
// Keeps references, which cost hours, from being replaced by a slip.

#include <string>

namespace gib {

/// Throws InputError if the file is a reference: `render` never replaces one.
void require_no_reference(const std::string& path);

/// Throws InputError if there is an image at `path` that is not the reference of this scene by this method at this
/// size. A file that cannot be read is no reference that could be lost.
void require_own_reference(const std::string& path, const std::string& key);

}  // namespace gib
