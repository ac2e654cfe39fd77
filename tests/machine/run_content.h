#pragma once
// The content that all runs of one experiment share, whatever the machine did to them.

#include <map>
#include <string>

namespace gib::test {

/// The content of a result folder that has to be the same in every run: images by their bytes (the reference's by its
/// pixels), table.csv without times and memory, and the names of all files.
std::map<std::string, std::string> content_of(const std::string& folder);

}  // namespace gib::test
