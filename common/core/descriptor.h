#pragma once
// A file descriptor of the system that closes itself.

#include <unistd.h>
#include <utility>

namespace gib {

class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }

    /// Negative if nothing was opened.
    int get() const { return fd_; }
    /// False if the last buffered bytes could not be stored.
    bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

private:
    int fd_;
};

}  // namespace gib
