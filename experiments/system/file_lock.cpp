#include "experiments/system/file_lock.h"

#include "common/core/files.h"
#include "common/core/reject.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace gib {

std::optional<FileLock> FileLock::if_free(const std::string& path) {
    for (;;) {
        // The file is closed on exec, because the lock belongs to the run alone; a cell's process dies with its run.
        Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
        const int fd = file.get();
        if (fd < 0) reject({path}, "cannot write here: {}", std::strerror(errno));
        if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
            if (errno == EWOULDBLOCK) return std::nullopt;
            if (errno == EINTR) continue;
            reject({path}, "cannot lock this file: {}", std::strerror(errno));
        }
        // Its last owner may have removed the file after it was opened here.
        if (struct stat status{}; ::fstat(fd, &status) != 0 || status.st_nlink == 0) continue;
        // On a full disk the pid is missing, but the lock holds without it.
        const std::string pid = fmt::format("{}\n", ::getpid());
        if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, pid.data(), pid.size(), 0) < 0) errno = 0;
        return FileLock(path, std::move(file));
    }
}

FileLock::FileLock(FileLock&& other) noexcept : path_(std::exchange(other.path_, "")), file_(std::move(other.file_)) {}

FileLock::~FileLock() {
    if (!path_.empty()) ::unlink(path_.c_str());
}

bool is_locked(const std::string& path) { return std::filesystem::exists(path) && !FileLock::if_free(path); }

std::string lock_owner(const std::string& path) {
    try {
        const std::string text = read_file(path);
        const std::string pid = text.substr(0, text.find('\n'));
        if (!pid.empty() && std::ranges::all_of(pid, [](char c) { return c >= '0' && c <= '9'; }))
            return "process " + pid;
    } catch (const InputError&) {
        // The owner has ended and has removed the file.
    }
    return "another process";
}

FileLock lock_result_folder(const std::string& folder) {
    const std::string path = folder + "/.lock";
    if (auto lock = FileLock::if_free(path)) return std::move(*lock);
    reject({}, "{} is working in '{}': wait until it has ended; a run can have another folder by --out",
           lock_owner(path), folder);
}

FileLock lock_reference(const std::string& path, const std::function<void(const std::string& owner)>& waiting) {
    const std::string file = path + ".lock";
    for (bool said = false;; said = true) {
        if (auto lock = FileLock::if_free(file)) return std::move(*lock);
        InterruptGuard::check();
        if (!said) waiting(lock_owner(file));
        // Short waits: a signal that arrives between the check and a long wait would be missed until its end.
        ::usleep(50'000);
    }
}

}  // namespace gib
