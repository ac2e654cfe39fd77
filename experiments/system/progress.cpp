#include "experiments/system/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace gib {

namespace {

/// Writes to stderr. If stderr is full or closed, the text is lost, which is no reason to end a run.
void say(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace

ProgressLine::ProgressLine(std::optional<bool> terminal, std::optional<double> seconds)
    : terminal_(terminal.value_or(isatty(STDERR_FILENO) == 1)), wait_(seconds.value_or(terminal_ ? 0.1 : 10.0)) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::update(double fraction, std::optional<double> seconds_left, const std::string& what) {
    if (quiet) return;
    const auto now = std::chrono::steady_clock::now();
    if (!last_ && !terminal_) last_ = now;  // short work needs no line
    if (last_ && now - *last_ < wait_) return;
    last_ = now;
    fraction = std::clamp(fraction, 0.0, 1.0);
    const std::string left = seconds_left ? fmt::format(", {} left", duration_text(*seconds_left)) : "";
    const int percent = static_cast<int>(100 * fraction);
    if (!terminal_) {
        const std::string line = fmt::format("{:3} %{}  {}\n", percent, left, what);
        if (line != line_) say(line);
        line_ = line;
    } else {
        constexpr int width = 24;
        const auto full = static_cast<std::size_t>(std::lround(fraction * width));
        say(fmt::format("\r\033[2K[{}{}] {:3} %{}  {}", std::string(full, '#'), std::string(width - full, '.'), percent,
                        left, what));
        drawn_ = true;
    }
}

void ProgressLine::message(const std::string& text) {
    clear();
    say(text + "\n");
}

void ProgressLine::note(const std::string& text) {
    if (!quiet) message(text);
}

void ProgressLine::clear() {
    if (std::exchange(drawn_, false)) say("\r\033[2K");
}

std::string duration_text(double seconds) {
    const auto s = static_cast<long>(std::ceil(std::max(seconds, 0.0)));
    if (s < 100) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace gib
