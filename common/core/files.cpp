#include "common/core/files.h"

#include "common/core/descriptor.h"
#include "common/core/error.h"
#include "common/core/memory_limit.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <nettle/sha1.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

namespace gib {

namespace {

constexpr std::string_view temporary_mark = ".tmp-";
constexpr std::size_t temporary_letters = 6;  // the number that mkostemp() requires
constexpr std::size_t piece_bytes = std::size_t{256} << 10;

[[noreturn]] void fail(const std::string& path, const char* what, int error = errno) {
    throw RunError(fmt::format("{}: {}: {}", path, what, std::strerror(error)));
}

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

    int descriptor() const { return descriptor_->get(); }
    void move_to(const std::string& target, Flush flush) {
        // mkostemp() makes a private file; a result must be as readable as any other new file.
        const mode_t mask = ::umask(0);
        ::umask(mask);
        if (::fchmod(descriptor_->get(), 0666 & ~mask) != 0) fail(target, "cannot set its permissions");
        if (flush == Flush::now && ::fsync(descriptor_->get()) != 0) fail(target, "cannot write");
        // The file is renamed before it is closed, because closing gives up the lock.
        if (::rename(path_.c_str(), target.c_str()) != 0) fail(target, "cannot write");
        path_.clear();
        if (!descriptor_->close()) fail(target, "cannot write");
    }

private:
    std::string path_;
    std::unique_ptr<Descriptor> descriptor_;
};

std::string binary_digest(std::string_view data) {
    sha1_ctx sha;
    sha1_init(&sha);
    sha1_update(&sha, data.size(), reinterpret_cast<const std::uint8_t*>(data.data()));
    std::array<std::uint8_t, SHA1_DIGEST_SIZE> digest;
    sha1_digest(&sha, digest.size(), digest.data());
    return {reinterpret_cast<const char*>(digest.data()), digest.size()};
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
    std::error_code not_regular;
    const bool is_folder = std::filesystem::is_directory(path, not_regular);
    std::ifstream file(path, std::ios::binary);
    const auto fail = [&] {
        const char* why = is_folder ? "it is a folder" : std::strerror(errno);
        throw InputError({path, 0, 0}, fmt::format("cannot read the file: {}", why));
    };
    if (is_folder || !file) fail();
    std::string content;
    if (const auto size = std::filesystem::file_size(path, not_regular); !not_regular) {
        require_memory(static_cast<double>(size), "the file", {path, 0, 0});
        content.resize(size);
        if (!file.read(content.data(), static_cast<std::streamsize>(size))) fail();
    } else {  // a pipe
        content.assign(std::istreambuf_iterator<char>(file), {});
    }
    return content;
}

void FileContent::write(std::string_view data) {
    if (pending_.size() + data.size() > piece_bytes) flush();
    if (data.size() > piece_bytes) hand_over(data);
    else pending_.append(data);
}

void FileContent::seek(std::uint64_t position) {
    flush();
    if (::lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0) error_ = errno;
    written_ = position;
}

void FileContent::flush() {
    hand_over(pending_);
    pending_.clear();
}

void FileContent::hand_over(std::string_view data) {
    while (error_ == 0 && !data.empty()) {
        const ssize_t written = ::write(descriptor_, data.data(), data.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            error_ = errno;
            break;
        }
        written_ += static_cast<std::uint64_t>(written);
        data.remove_prefix(static_cast<std::size_t>(written));
    }
    if (error_ != 0) fail(path_, "cannot write", error_);
}

void write_file(const std::string& path, std::string_view content, Flush flush) {
    write_file(
        path, [&](FileContent& file) { file.write(content); }, flush);
}

void write_file(const std::string& path, const std::function<void(FileContent&)>& make, Flush flush) {
    TemporaryFile temporary(path);
    FileContent content(temporary.descriptor(), path);
    make(content);
    content.flush();
    temporary.move_to(path, flush);
    if (flush == Flush::later) return;
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
