#pragma once
// The time that a tuning has used, over all its runs: a tuning that goes on after an interruption makes the decisions of
// one that was never interrupted, so that it asks for the same cells and finds them stored.

#include <functional>
#include <map>
#include <string>

namespace gib {

/// Seconds of a clock that never goes back.
double steady_seconds();

class TuningClock {
public:
    /// `file` keeps the times of rounds; a file that cannot be read counts as none. `now` returns seconds.
    explicit TuningClock(std::string file, std::function<double()> now = steady_seconds);

    /// Begins a round. `content` is what the round measures: a record of another content is dropped, and so is one whose
    /// results are not stored any more.
    void begin(const std::string& name, const std::string& content, bool is_stored = true);
    /// Ends the round and stores its time. One that is not done adds to it when it begins again. `is_cut`: whether the
    /// round left out cells for lack of time.
    void end(bool is_done, bool is_cut = false);

    /// The seconds of all rounds that have begun here, the present one included.
    double used() const;
    /// Whether the present round was done by an earlier run, and then adds no time.
    bool was_done() const { return present_->second.is_done; }
    /// Whether the present round is known to have left out cells.
    bool was_cut() const { return present_->second.is_cut; }

private:
    struct Record {
        std::string content;  ///< hash
        double seconds = 0;
        bool is_done = false, is_cut = false;
    };
    using Records = std::map<std::string, Record>;

    void write() const;

    std::string file_;
    std::function<double()> now_;
    Records records_;
    Records::iterator present_ = records_.end();
    double before_ = 0;   ///< seconds of the rounds before the present one
    double started_ = 0;  ///< time at which the present one began [s]
    bool is_running_ = false;
};

}  // namespace gib
