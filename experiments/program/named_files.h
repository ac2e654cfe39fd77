#pragma once
// Files that the command line names: scenes and experiments that come with the program, and references, which cost hours, so that
// no slip may replace one.

#include <string>
#include <vector>

namespace gib {

/// The names, as `gibench list scenes` and `gibench list experiments` print them, in alphabetical order.
std::vector<std::string> shipped_scene_names();
std::vector<std::string> shipped_experiment_names();

/// The file of a scene or experiment that is given by its path or, where there is no such file, by the name of one that
/// comes with the program. Both throw InputError, with the name that was probably meant, if there is neither.
std::string scene_file(const std::string& path_or_name);
std::string experiment_file(const std::string& path_or_name);

/// Throws InputError if the file is a reference: `render` never replaces one.
void require_no_reference(const std::string& path);

/// Throws InputError if there is an image at `path` that is not the reference of this scene by this method at this size.
/// A file that cannot be read is no reference that could be lost.
void require_own_reference(const std::string& path, const std::string& key);

}  // namespace gib
