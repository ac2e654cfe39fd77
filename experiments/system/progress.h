#pragma once
// Progress on stderr: one line that is redrawn on a terminal, plain lines otherwise.

#include <chrono>
#include <optional>
#include <string>

namespace gib {

class ProgressLine {
public:
    /// `terminal`: whether to draw a bar; if not given, whether stderr is a terminal.
    explicit ProgressLine(std::optional<bool> terminal = std::nullopt);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// Shows a state: a share of the work in [0, 1] and the seconds left, if they are known. Rate-limited: ten times a
    /// second on a terminal, once in ten seconds otherwise.
    void update(double fraction, std::optional<double> seconds_left, const std::string& what);
    /// A line that stays.
    void message(const std::string& text);

private:
    void clear();

    bool terminal_;
    bool drawn_ = false;
    std::optional<std::chrono::steady_clock::time_point> last_;
};

/// "12 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);

}  // namespace gib
