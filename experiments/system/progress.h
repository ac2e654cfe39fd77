#pragma once
// Progress on stderr: one line that is redrawn on a terminal, plain lines otherwise.

#include <chrono>
#include <optional>
#include <string>

namespace gib {

class ProgressLine {
public:
    /// `terminal`: whether to draw a bar; if not given, whether stderr is a terminal. `seconds`: the least time between two
    /// updates; if not given, a tenth of a second on a terminal and ten seconds elsewhere.
    explicit ProgressLine(std::optional<bool> terminal = std::nullopt, std::optional<double> seconds = std::nullopt);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// Shows the share of the work that is done, in [0, 1], the seconds left, if they are known, and `what` is being
    /// done. Where no bar is drawn, a line that is equal to the last one is left out.
    void update(double fraction, std::optional<double> seconds_left, const std::string& what);
    /// Prints a line that stays.
    void message(const std::string& text);
    /// message() for notes, which are neither warnings nor errors.
    void note(const std::string& text);

    bool quiet = false;  ///< whether update() and note() show nothing

private:
    void clear();

    bool terminal_;
    std::chrono::duration<double> wait_;
    bool drawn_ = false;
    std::string line_;  ///< the last one that was printed
    std::optional<std::chrono::steady_clock::time_point> last_;
};

/// A duration as text: "12 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);

}  // namespace gib
