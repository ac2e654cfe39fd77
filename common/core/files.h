#pragma once
// Reads and writes whole files and computes hashes of content. A file that is written appears whole or not at all.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace gib {

/// The content of a file. Throws InputError with the file's name if it cannot be read or needs more memory
/// than there is.
std::string read_file(const std::string& path);
/// When a written file reaches the disk. `now` waits for it, about 10 ms: for results that a later run relies on even if the
/// power has failed in between. `later` leaves it to the system.
enum class Flush { now, later };
/// The content of a file that is being written. It goes to the system in pieces of 256 KiB, so that no copy of the whole
/// file is made.
class FileContent {
public:
    /// `descriptor` is open for writing at its start and outlives the content; `path` is the file that messages name.
    FileContent(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}

    /// Writes at position(). Throws RunError.
    void write(std::string_view data);
    /// Where the next byte goes [bytes from the start].
    std::uint64_t position() const { return written_ + pending_.size(); }
    void seek(std::uint64_t position);
    /// Hands all content to the system. Throws RunError, also if an earlier call of any function has thrown it.
    void flush();

private:
    void hand_over(std::string_view data);

    int descriptor_;
    std::string path_;
    std::string pending_;  ///< to be written at written_
    std::uint64_t written_ = 0;
    int error_ = 0;  ///< errno of the first failure
};

/// Calls `make` to write a temporary file in the same folder, flushes it to disk if asked to and renames it to `path`.
/// Throws RunError.
void write_file(const std::string& path, const std::function<void(FileContent&)>& make, Flush flush = Flush::now);
void write_file(const std::string& path, std::string_view content, Flush flush = Flush::now);
/// Removes the temporary files that write_file() left in `folder` when its process died, but not those in folders
/// below. For folders to which only the bench writes.
void remove_leftovers_in(const std::string& folder);
/// Removes only the temporary files that write_file() left for `file`. For folders in which files of other programs
/// may have similar names.
void remove_leftovers_of(const std::string& file);

/// A hash of everything that a result depends on.
class ContentHash {
public:
    /// Adds a piece of data. The hash also depends on where one piece ends and the next begins.
    void add(std::string_view piece);
    /// Adds all pieces of another hash.
    void add(const ContentHash& other) { pieces_ += other.pieces_; }
    /// SHA-1 of all pieces, 40 hexadecimal digits.
    std::string hex() const;

private:
    std::string pieces_;  ///< the SHA-1 of each piece so far, one after another
};

}  // namespace gib
