#pragma once
// JSON files that gibench wrote and reads again: something may have happened to them meanwhile.

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace gib {

/// The file's content. Throws nlohmann::json::parse_error if it is no JSON, InputError if it cannot be read or is
/// nested deeper than any file of ours: comparing, copying and writing such a value would overflow the stack.
nlohmann::json read_json(const std::string& path);

/// SHA-1 of a record's text, which says all of it: numbers are read back as they were written, and keys are sorted.
std::string json_digest(const nlohmann::json& record);

}  // namespace gib
