#pragma once
// Files that one process at a time works with. The kernel gives a lock back when its process ends, however it ends.

#include <sys/types.h>
#include <functional>
#include <optional>
#include <string>

namespace gib {

/// A locked file, which exists for its lock alone: it holds the pid of its owner and is removed with the lock.
class FileLock {
public:
    /// Empty if another process has it. Throws InputError if the file cannot be made.
    static std::optional<FileLock> if_free(const std::string& path);

    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&&) = delete;
    ~FileLock();

private:
    FileLock(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}

    std::string path_;
    int fd_;
};

/// "process 1234", or "another process" if its owner has not said its pid.
std::string lock_owner(const std::string& path);

/// Locks a result folder, which must exist. Throws InputError, with the pid, if another run or report works in it or if
/// nothing can be written there.
FileLock lock_result_folder(const std::string& folder);

/// Locks the file of a reference; `waiting` is told once whom it waits for. Throws Interrupted on Ctrl-C.
FileLock lock_reference(const std::string& path, const std::function<void(const std::string& owner)>& waiting);

}  // namespace gib
