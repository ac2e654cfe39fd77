#include "common/core/files.h"

#include "common/core/error.h"
#include "common/core/memory_limit.h"

#include <OpenImageIO/hash.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

namespace gib {

namespace {

/// A file descriptor that closes itself.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    /// False if the last buffered bytes could not be stored.
    bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

private:
    int fd_;
};

constexpr std::string_view temporary_mark = ".tmp-";
constexpr std::size_t temporary_letters = 6;  // the number that mkostemp() requires

/// A temporary file, which is deleted unless it was renamed to its target. Its writer holds a lock on it; a temporary
/// file without a lock was left by a process that died.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& target) {
        struct stat status {};
        do {  // again if another process removed it as a left-over before it was locked
            path_ = target + std::string(temporary_mark) + std::string(temporary_letters, 'X');
            descriptor_ = std::make_unique<Descriptor>(::mkostemp(path_.data(), O_CLOEXEC));
            if (descriptor_->get() < 0) {
                path_.clear();
                fail(target, "cannot create a file in its folder");
            }
            // remove_leftovers_in() of another process may hold the lock for a moment.
            while (::flock(descriptor_->get(), LOCK_EX) != 0 && errno == EINTR) {
            }
        } while (::fstat(descriptor_->get(), &status) == 0 && status.st_nlink == 0);
    }
    ~TemporaryFile() {
        if (!path_.empty()) ::unlink(path_.c_str());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::string_view content, const std::string& target) {
        while (!content.empty()) {
            const ssize_t written = ::write(descriptor_->get(), content.data(), content.size());
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) fail(target, "cannot write");
            content.remove_prefix(static_cast<std::size_t>(written));
        }
    }
    void move_to(const std::string& target) {
        // mkostemp() makes a private file; a result must be as readable as any other new file.
        const mode_t mask = ::umask(0);
        ::umask(mask);
        if (::fchmod(descriptor_->get(), 0666 & ~mask) != 0) fail(target, "cannot set its permissions");
        if (::fsync(descriptor_->get()) != 0) fail(target, "cannot write");
        // The file is renamed before it is closed, because closing gives up the lock.
        if (::rename(path_.c_str(), target.c_str()) != 0) fail(target, "cannot write");
        path_.clear();
        if (!descriptor_->close()) fail(target, "cannot write");
    }

private:
    [[noreturn]] static void fail(const std::string& target, const char* what) {
        const int error = errno;
        throw RunError(fmt::format("{}: {}: {}", target, what, std::strerror(error)));
    }

    std::string path_;
    std::unique_ptr<Descriptor> descriptor_;
};

std::string binary_digest(std::string_view data) {
    OIIO::SHA1 sha;
    // Lengths have 32 bits inside OIIO::SHA1, so that longer data are added in blocks of 2^30 bytes.
    constexpr std::size_t block = std::size_t{1} << 30;
    for (std::size_t i = 0; i < data.size(); i += block)
        sha.append(data.data() + i, std::min(block, data.size() - i));
    OIIO::SHA1::Hash hash;
    sha.gethash(hash);
    return {reinterpret_cast<const char*>(hash.hash), sizeof hash.hash};
}

/// Removes the temporary files without a lock in `folder` if `ours(name)` is true for the name of their target.
template <typename Ours>
void remove_leftovers(const std::filesystem::path& folder, const Ours& ours) {
    namespace fs = std::filesystem;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        const std::size_t tail = temporary_mark.size() + temporary_letters;
        if (name.size() <= tail || name.compare(name.size() - tail, temporary_mark.size(), temporary_mark) != 0)
            continue;
        if (!ours(std::string_view(name).substr(0, name.size() - tail))) continue;
        const Descriptor file(::open(entry->path().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
        if (file.get() >= 0 && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(entry->path().c_str());
    }
}

}  // namespace

std::string read_file(const std::string& path) {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat status {};
    if (file.get() < 0 || ::fstat(file.get(), &status) != 0)
        throw InputError({path, 0, 0}, fmt::format("cannot read the file: {}", std::strerror(errno)));
    if (S_ISDIR(status.st_mode)) throw InputError({path, 0, 0}, "cannot read the file: it is a folder");
    require_memory(static_cast<double>(status.st_size), "the file", {path, 0, 0});
    // The buffer is one byte longer than the size, so that the end is found without growing it. The size is only a
    // hint: a pipe has none, and a file may grow.
    std::string content(static_cast<std::size_t>(status.st_size) + 1, '\0');
    std::size_t size = 0;
    for (;;) {
        if (size == content.size()) {
            const std::size_t larger = size + std::max<std::size_t>(size / 2, 4096);
            // The old buffer is kept until it is copied, so that memory for all of the new one must be available.
            require_memory(static_cast<double>(larger), "the file", {path, 0, 0});
            content.resize(larger);
        }
        const ssize_t n = ::read(file.get(), content.data() + size, content.size() - size);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw InputError({path, 0, 0}, fmt::format("cannot read the file: {}", std::strerror(errno)));
        if (n == 0) break;
        size += static_cast<std::size_t>(n);
    }
    content.resize(size);
    return content;
}

void write_file(const std::string& path, std::string_view content) {
    TemporaryFile temporary(path);
    temporary.write(content, path);
    temporary.move_to(path);
    // The new name is part of the folder, which has to reach the disk too. Not every file system can flush a folder,
    // so that a failure is ignored.
    const std::string folder = std::filesystem::path(path).parent_path().string();
    const Descriptor directory(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (directory.get() >= 0) ::fsync(directory.get());
}

void remove_leftovers_in(const std::string& folder) {
    remove_leftovers(folder, [](std::string_view) { return true; });
}

void remove_leftovers_of(const std::string& file) {
    const std::filesystem::path path = std::filesystem::absolute(file);
    remove_leftovers(path.parent_path(), [name = path.filename().string()](std::string_view of) { return of == name; });
}

void ContentHash::add(std::string_view piece) { pieces_ += binary_digest(piece); }

std::string ContentHash::hex() const {
    std::string text;
    for (const char c : binary_digest(pieces_))
        text += fmt::format("{:02x}", static_cast<unsigned char>(c));
    return text;
}

}  // namespace gib
