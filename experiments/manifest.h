#pragma once
// manifest.json: everything that a result depends on and that its tables do not say.

#include "experiments/result_folder.h"

#include <string>

namespace gib {

/// `command_line`: as it was typed. `threads`: that computed.
std::string manifest_text(const ResultIndex& index, const std::string& command_line);

/// The processor's name as the system gives it.
std::string cpu_model();

}  // namespace gib
