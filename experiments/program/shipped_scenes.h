#pragma once
// The scenes that come with the program, by name.

#include <string>
#include <vector>

namespace gib {

/// The names, as `gibench list scenes` prints them, in alphabetical order.
std::vector<std::string> shipped_scene_names();

/// The file of a scene that is given by its path or, where there is no such file, by the name of a scene that comes with
/// the program. Throws InputError, with the name that was probably meant, if there is neither.
std::string scene_file(const std::string& path_or_name);

}  // namespace gib
