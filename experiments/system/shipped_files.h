#pragma once
// The scenes and experiments that come with the program, which have names.

#include <string>
#include <vector>

namespace gib {

/// The names, as `gibench list scenes` and `gibench list experiments` print them, in alphabetical order.
std::vector<std::string> shipped_scene_names();
std::vector<std::string> shipped_experiment_names();

/// The file of the scene of this name; empty if none that comes with the program has it.
std::string shipped_scene(const std::string& name);

/// The file of a scene or experiment that is given by its path or, where there is no such file, by the name of one that
/// comes with the program. Both throw InputError, with the name that was probably meant, if there is neither.
std::string scene_file(const std::string& path_or_name);
std::string experiment_file(const std::string& path_or_name);

}  // namespace gib
