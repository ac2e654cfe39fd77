#pragma once
// Reads JSON files that gibench wrote and that may have been damaged since.

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace gib {

/// The file's content. Throws nlohmann::json::parse_error if it is not JSON, InputError if it cannot be read.
nlohmann::json read_json(const std::string& path);

/// SHA-1 of a record's text. The text is the same for a record that was written and read again, because numbers are
/// read exactly and keys are sorted.
std::string json_digest(const nlohmann::json& record);

}  // namespace gib
