#include "experiments/external/commands.h"

#include "common/core/descriptor.h"
#include "common/core/error.h"
#include "common/core/files.h"
#include "common/images/image_file.h"
#include "experiments/measuring/child_request.h"
#include "experiments/system/interrupt.h"

#include <fcntl.h>
#include <fmt/format.h>
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
#include <map>
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

/// Kills what a command has left behind, in whatever group or session. An orphan becomes a child of this process, which
/// is a subreaper; each round therefore finds the children of those that the last one has killed.
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

/// The last line of a file that is not empty.
std::string last_line(const std::string& file) {
    std::istringstream text(read_file(file));
    std::string last;
    for (std::string line; std::getline(text, line);)
        if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    return last;
}

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).lexically_normal().string(); }

/// Throws RunError with the last line of the command's standard error.
[[noreturn]] void fail(const CommandCell& cell, const std::string& what) {
    const std::string messages = cell.cell_folder + "/stderr.txt";
    const std::string said = last_line(messages);
    throw RunError(said.empty() ? what : fmt::format("{}; its last message: {} (all are in {})", what, said, messages));
}

/// `name`: in messages, such as "its command".
void require_success(const CommandCell& cell, const char* name, const CommandResult& result) {
    if (result.timed_out)
        fail(cell, fmt::format("{} was ended after its timeout of {:g} s", name, cell.method.timeout));
    // A shell reports the signal that ended its command as the exit code 128 + signal.
    const bool told_by_shell = result.exit_code > 128 && result.exit_code < 128 + 32;
    if (const int signal = told_by_shell ? result.exit_code - 128 : result.signal; signal != 0)
        fail(cell, fmt::format("{} was killed by signal {} ({})", name, signal, strsignal(signal)));
    if (result.exit_code != 0) fail(cell, fmt::format("{} ended with exit code {}", name, result.exit_code));
}

Image image_of(const CommandCell& cell, const char* name, const std::string& file) {
    if (!std::filesystem::exists(file)) fail(cell, fmt::format("{} wrote no image", name));
    LayeredImage layers;
    try {
        layers = read_image(file);
    } catch (const InputError& error) {
        fail(cell, fmt::format("its image cannot be read: {}", error.what()));
    }
    const Image* image = layers.find("");
    if (!image) fail(cell, "its image has no channels R,G,B");
    if (image->width != cell.width || image->height != cell.height)
        fail(cell, fmt::format("its image has {} x {} pixels, the scene has {} x {}", image->width, image->height,
                               cell.width, cell.height));
    if (const std::size_t bad = image->non_finite_values(); bad > 0) {
        const auto first = std::ranges::find_if(image->rgb, [](float v) { return !std::isfinite(v); });
        const auto pixel = static_cast<int>((first - image->rgb.begin()) / 3);
        fail(cell, fmt::format("{} of the {} values of its image are not finite, the first in column {} of row {}", bad,
                               image->rgb.size(), pixel % image->width, pixel / image->width));
    }
    return *image;
}

struct CommandImage {
    Image image;
    CommandResult cost;
};

/// Runs the command with these values of its placeholders; it writes the image `out`.
CommandImage image_by_command(const CommandCell& cell, const char* name, std::map<std::string, std::string> values) {
    values["threads"] = std::to_string(cell.threads);
    const CommandRequest request{.command = filled_command(cell.method, values),
                                 .folder = cell.folder,
                                 .timeout = cell.method.timeout,
                                 .cell_folder = cell.cell_folder,
                                 .work_folder = cell.work_folder};
    const auto cost = result_of_child<CommandResult>("measure-command", request, [](const std::string&) {});
    require_success(cell, name, cost);
    return {image_of(cell, name, values["out"]), cost};
}

/// The files that a filter reads, which are layers of a checkpoint's image, and the one that it writes.
std::map<std::string, std::string> files_of(const CommandCell& cell, const LayeredImage& image) {
    const std::string work = absolute(cell.work_folder) + "/";
    std::map<std::string, std::string> files = {{"out", work + "filtered.exr"}};
    for (const auto& [layer, pixels] : image.layers) {
        const std::string name = layer.empty() ? "image" : layer;
        if (!cell.method.takes(name)) continue;
        files[name] = work + name + ".exr";
        write_scratch_exr(files[name], {{{"", pixels}}, {}});
    }
    return files;
}

}  // namespace

void measure_command(const std::string& request_file) {
    const auto request = request_of_parent<CommandRequest>(request_file);
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // which ends the command, too
    leave_result(request, measured(request));
}

Measurement run_external_cell(const CommandCell& cell, const RendererInput& input) {
    const std::string work = absolute(cell.work_folder);
    std::map<std::string, std::string> values = {
        {"scene", absolute(input.scene_file)}, {"out", work + "/image." + cell.method.image_format},
        {"spp", std::to_string(input.spp)},    {"seed", std::to_string(input.seed)},
        {"width", std::to_string(cell.width)}, {"height", std::to_string(cell.height)}};
    if (input.seconds) values["seconds"] = fmt::format("{}", *input.seconds);
    const auto [image, cost] = image_by_command(cell, "its command", std::move(values));
    write_scratch_exr(checkpoint_image(cell.work_folder, input.spp), {{{"", image}}, {}});
    Measurement result;
    result.checkpoints.push_back(
        {.passes = input.spp, .seconds = cost.seconds, .counts = {}, .peak_rss_mib = cost.peak_rss_mib});
    result.stages.push_back({"command", cost.seconds});
    return result;
}

void filter_checkpoints(const CommandCell& cell, Measurement& measured) {
    double last = 0;  // [s]
    for (Checkpoint& checkpoint : measured.checkpoints) {
        const std::string path = checkpoint_image(cell.work_folder, checkpoint.passes);
        auto values = files_of(cell, read_image(path));
        std::filesystem::remove(values["out"]);
        const auto [filtered, cost] = image_by_command(cell, "its filter", std::move(values));
        write_scratch_exr(path, {{{"", filtered}}, {}});
        last = cost.seconds;
        checkpoint.seconds += last;
        checkpoint.peak_rss_mib = std::max(checkpoint.peak_rss_mib, cost.peak_rss_mib);
    }
    measured.stages.push_back({"command", last});
}

}  // namespace gib
