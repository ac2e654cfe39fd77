#include "experiments/external/command_process.h"

#include "common/core/descriptor.h"
#include "common/core/error.h"
#include "experiments/measuring/child_request.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

namespace gib {

static auto json_fields(RecordOf<CommandRequest> auto& r) {
    return std::tuple(JsonField{"command", r.command}, JsonField{"folder", r.folder}, JsonField{"timeout", r.timeout},
                      JsonField{"cell_folder", r.cell_folder}, JsonField{"work_folder", r.work_folder});
}

static auto json_fields(RecordOf<CommandResult> auto& r) {
    return std::tuple(JsonField{"seconds", r.seconds}, JsonField{"peak_rss_mib", r.peak_rss_mib},
                      JsonField{"timed_out", r.timed_out}, JsonField{"exit_code", r.exit_code},
                      JsonField{"signal", r.signal});
}

namespace {

using Clock = std::chrono::steady_clock;

Descriptor opened(const std::string& file, int flags) {
    Descriptor descriptor(open(file.c_str(), flags | O_CLOEXEC, 0666));
    if (descriptor.get() < 0) throw RunError(fmt::format("cannot open '{}': {}", file, std::strerror(errno)));
    return descriptor;
}

/// The signals that end the wait for a command.
sigset_t awaited_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGCHLD, SIGTERM, SIGINT})
        sigaddset(&signals, signal);
    return signals;
}

/// Becomes the shell that runs the command, in a process group of its own. It runs between fork() and exec, where only
/// system calls are allowed.
[[noreturn]] void become_shell(const CommandRequest& request, int input, int output, int messages, pid_t parent,
                               const sigset_t& signals_before) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent && chdir(request.folder.c_str()) == 0 && dup2(input, STDIN_FILENO) >= 0 &&
        dup2(output, STDOUT_FILENO) >= 0 && dup2(messages, STDERR_FILENO) >= 0) {
        sigprocmask(SIG_SETMASK, &signals_before, nullptr);
        execl("/bin/sh", "sh", "-c", request.command.c_str(), static_cast<char*>(nullptr));
    }
    _exit(127);
}

/// Waits for a signal until `end`; 0 if none came.
int signal_before(const Clock::time_point& end, const sigset_t& signals) {
    const auto left = std::max(Clock::duration::zero(), end - Clock::now());
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec wait{seconds.count(), std::chrono::nanoseconds(left - seconds).count()};
    return std::max(0, sigtimedwait(&signals, nullptr, &wait));
}

/// The processes whose parent is this one.
std::vector<pid_t> children() {
    std::vector<pid_t> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
        std::ifstream file(entry.path() / "stat");
        // PID (NAME) STATE PARENT; a name may have blanks and parentheses.
        std::string line;
        if (!std::getline(file, line, '\0')) continue;
        const std::size_t after_name = line.rfind(')');
        char state = 0;
        pid_t parent = 0;
        if (after_name == line.npos || !(std::istringstream(line.substr(after_name + 1)) >> state >> parent)) continue;
        if (parent == getpid()) found.push_back(static_cast<pid_t>(std::stol(line)));
    }
    return found;
}

/// Kills what a command has left behind, in whatever group or session. An orphan becomes a child of this process, which is a
/// subreaper; each round therefore finds the children of those that the last one has killed.
void kill_descendants() {
    constexpr int most_rounds = 1000;  // some processes may not be killed, such as those of another user
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<pid_t> left = children();
        if (left.empty()) return;
        for (const pid_t child : left)
            kill(child, SIGKILL);
        while (waitpid(-1, nullptr, WNOHANG) > 0) {
        }
        usleep(1000);
    }
}

CommandResult measured(const CommandRequest& request) {
    constexpr double longest = 1e8;  // [s], so that the clock cannot overflow
    const Descriptor input = opened("/dev/null", O_RDONLY);
    const Descriptor output = opened(request.cell_folder + "/stdout.txt", O_WRONLY | O_CREAT | O_TRUNC);
    const Descriptor messages = opened(request.cell_folder + "/stderr.txt", O_WRONLY | O_CREAT | O_TRUNC);
    const sigset_t signals = awaited_signals();
    sigset_t before;
    sigprocmask(SIG_BLOCK, &signals, &before);
    const pid_t parent = getpid();
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const auto start = Clock::now();
    const auto end = start + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(std::min(request.timeout, longest)));
    const pid_t child = fork();
    if (child < 0) throw RunError(fmt::format("cannot start a shell: {}", std::strerror(errno)));
    if (child == 0) become_shell(request, input.get(), output.get(), messages.get(), parent, before);
    setpgid(child, child);

    CommandResult result;
    int status = 0;
    rusage usage{};
    while (wait4(child, &status, WNOHANG, &usage) == 0) {
        const int signal = signal_before(end, signals);
        const bool interrupted = signal == SIGTERM || signal == SIGINT;
        result.timed_out = !interrupted && signal == 0 && Clock::now() >= end;
        if (!interrupted && !result.timed_out) continue;
        kill(-child, SIGKILL);
        wait4(child, &status, 0, &usage);
        if (!interrupted) break;
        kill_descendants();
        throw Interrupted();
    }
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    kill_descendants();
    result.peak_rss_mib = static_cast<double>(usage.ru_maxrss) / 1024;
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    return result;
}

}  // namespace

void measure_command(const std::string& request_file) {
    const auto request = request_of_parent<CommandRequest>(request_file);
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // which ends the command, too
    leave_result(request, measured(request));
}

CommandResult run_command(const std::string& program, const CommandRequest& request) {
    return result_of_child<CommandResult>(program, "measure-command", request, [](const std::string&) {});
}

}  // namespace gib
