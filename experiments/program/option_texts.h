#pragma once
// Texts of options that mean more than a number. Each function throws InputError, which names the option, for a text that it
// cannot read.

#include "experiments/plan/run_options.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// The values of --set NAME=VALUE, by name.
std::map<std::string, std::string> assignments(const std::vector<std::string>& texts);
/// The width and height of --resolution, such as 640x480.
std::pair<int, int> resolution_in(const std::string& text);
/// The share of --share, such as 0/4.
RunShare share_in(const std::string& text);

}  // namespace gib
