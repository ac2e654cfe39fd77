#pragma once
// Locks for what only one process may work with at a time. The kernel releases a lock when its process ends, even
// after a crash.

#include "common/core/descriptor.h"

#include <sys/types.h>
#include <functional>
#include <optional>
#include <string>

namespace gib {

/// A file that exists only to be locked: it holds the process id (pid) of its owner and is removed with the lock.
class FileLock {
public:
    /// The lock, or empty if another process has it. Throws InputError if the file cannot be created or locked.
    static std::optional<FileLock> if_free(const std::string& path);

    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&&) = delete;
    ~FileLock();

private:
    FileLock(std::string path, Descriptor file) : path_(std::move(path)), file_(std::move(file)) {}

    std::string path_;
    Descriptor file_;
};

/// Whether a process has this lock.
bool is_locked(const std::string& path);

/// The owner of a lock as text: "process 1234", or "another process" if the file does not hold a pid.
std::string lock_owner(const std::string& path);

/// Locks a result folder, which must exist. Throws InputError if another run or report works in it (the message gives
/// the pid) or if nothing can be written there.
FileLock lock_result_folder(const std::string& folder);

/// Waits until the file of a reference is free and locks it. `waiting` is called once if there is a wait, with the
/// owner of the lock. Throws Interrupted on Ctrl-C.
FileLock lock_reference(const std::string& path, const std::function<void(const std::string& owner)>& waiting);

}  // namespace gib
