#pragma once
// Files that appear whole or not at all, and hashes of their content.

#include <string>
#include <string_view>

namespace gib {

/// Throws InputError if it is a device, as /dev/zero, which never ends: before a library opens a file that we do not.
void require_no_device(const std::string& path);
/// Throws InputError with the file's name.
std::string read_file(const std::string& path);
/// Writes to a temporary file in the same folder, flushes it to disk and renames it. Throws RunError.
void write_file(const std::string& path, std::string_view content);
/// Removes what write_file() of dead processes left in a folder of ours, not in those below it.
void remove_leftovers_in(const std::string& folder);
/// The same of one file only: in a folder that is not ours others may have names like them.
void remove_leftovers_of(const std::string& file);

/// Collects what a result depends on.
class ContentHash {
public:
    /// Adds a piece; pieces cannot run into each other.
    void add(std::string_view piece);
    /// SHA-1 of all pieces, 40 hexadecimal digits.
    std::string hex() const;

private:
    std::string pieces_;  ///< the digests so far, one after another
};

}  // namespace gib
