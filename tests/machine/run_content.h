#pragma once
// What two runs of one experiment have in common whatever the machine did to them.

#include <map>
#include <string>

namespace gib::test {

/// Everything of a result folder that has to be the same in every run: images by their bytes (the reference's by its
/// pixels), table.csv without times and memory, and the names of all files.
std::map<std::string, std::string> content_of(const std::string& folder);

}  // namespace gib::test
