#include "experiments/system/child_process.h"

#include "common/core/descriptor.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>

extern char** environ;

namespace gib {

namespace {

[[noreturn]] void fail_to_start(const std::string& program, int error) {
    throw RunError(fmt::format("cannot start '{}': {}", program, std::strerror(error)));
}

/// The last line that is not empty of an open file.
std::string last_line(int fd) {
    std::ifstream file(fmt::format("/proc/self/fd/{}", fd));
    std::string last;
    for (std::string line; std::getline(file, line);)
        if (!line.empty()) last = line;
    return last;
}

pid_t spawn(const std::vector<std::string>& arguments, int output, int messages) {
    std::vector<char*> argv;
    for (const auto& argument : arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
    pid_t child = 0;
    const int error = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) fail_to_start(arguments[0], error);
    return child;
}

/// The status that waitpid() gives once the child has ended, or -1 if waitpid() fails; empty while the child runs.
std::optional<int> ended(pid_t child) {
    int status = 0;
    const pid_t done = waitpid(child, &status, WNOHANG);
    if (done == 0) return std::nullopt;
    return done == child ? status : -1;
}

void stop(pid_t child) {
    kill(child, SIGTERM);
    for (int i = 0; i < 20; ++i) {
        if (ended(child)) return;
        usleep(50'000);
    }
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
}

/// Passes the complete lines that have arrived to `on_line` and
/// keeps the rest in `pending`. False at the end of the stream.
bool read_lines(int fd, std::string& pending, const std::function<void(const std::string&)>& on_line) {
    char buffer[4096];
    const ssize_t count = read(fd, buffer, sizeof buffer);
    if (count < 0) return errno == EINTR || errno == EAGAIN;
    pending.append(buffer, static_cast<std::size_t>(count));
    for (std::size_t end; (end = pending.find('\n')) != std::string::npos; pending.erase(0, end + 1))
        on_line(pending.substr(0, end));
    return count > 0;
}

}  // namespace

void run_child(const std::vector<std::string>& arguments, const std::function<void(const std::string& line)>& on_line) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail_to_start(arguments[0], errno);
    const Descriptor reader(ends[0]);
    Descriptor writer(ends[1]);
    // The messages of the child stay in memory, so that a full disk cannot lose the message that reports it.
    const Descriptor messages(memfd_create("messages", MFD_CLOEXEC));
    if (messages.get() < 0) fail_to_start(arguments[0], errno);
    const pid_t child = spawn(arguments, writer.get(), messages.get());
    writer.close();
    std::string pending;
    std::optional<int> status;
    bool open = true;
    // Short waits instead of one long wait: a signal that arrives between the check and the wait would be missed
    // until its end.
    while (!status) {
        if (InterruptGuard::requested()) {
            stop(child);
            throw Interrupted();
        }
        pollfd wait{reader.get(), POLLIN, 0};
        if (!open) usleep(5'000);
        else if (poll(&wait, 1, 50) > 0) open = read_lines(reader.get(), pending, on_line);
        status = ended(child);
    }
    // The last lines of the child may still be in the pipe.
    for (pollfd rest{reader.get(), POLLIN, 0}; open && poll(&rest, 1, 0) > 0;)
        open = read_lines(reader.get(), pending, on_line);
    if (InterruptGuard::requested()) throw Interrupted();  // Ctrl-C reaches the child too
    if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0) return;
    const std::string said = last_line(messages.get());
    const std::string how =
        WIFSIGNALED(*status)
            ? fmt::format("its process was killed by signal {} ({})", WTERMSIG(*status), strsignal(WTERMSIG(*status)))
            : fmt::format("its process ended with exit code {}", WEXITSTATUS(*status));
    throw RunError(said.empty() ? how : said + " (" + how + ")");
}

void die_with_parent(int parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) throw RunError("the run that started this process has ended");
}

}  // namespace gib
