#pragma once
// The runs of a tuning, in one result folder: those that choose settings, under names of their own, and at the end an
// experiment of the best settings. A run that was measured before an interruption is found again and counts
// with the seconds in its record.

#include "experiments/plan/experiment_file.h"
#include "experiments/run/run_session.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gib {

class TuningRuns {
public:
    /// Checks everything and opens the folder. Throws InputError.
    TuningRuns(const TuneFile& file, const ExperimentScene& scene, const RunOptions& options,
               const std::vector<MethodLabel>& methods);

    /// Makes the reference, whose standard error is to be a quarter of the target, in at most so many seconds. If it is
    /// still above half of the target, the reference goes on to `most_seconds` at most. Returns a message if it stays
    /// above seven tenths of the target, else an empty text. Throws RunError if it cannot be made.
    std::string make_reference(double seconds, double most_seconds);

    struct Wanted {
        MethodLabel label;
        std::uint64_t seed;
        double budget;  ///< [s]; rounded to three digits
    };
    struct Run {
        std::optional<Cell> cell;  ///< empty: it failed or was left out
        bool is_left_out = false;  ///< for lack of time
    };
    /// Measures what is not stored yet, in this order, and begins nothing when used() is `deadline`. Throws
    /// Interrupted.
    std::vector<Run> measured(const std::vector<Wanted>& wanted, double deadline);

    /// From here on, runs are those of an experiment of these labels with the seeds 1 to `seeds`, each with its own
    /// budget.
    void begin_experiment(const std::vector<MethodLabel>& labels, const std::vector<double>& budgets, int seeds);
    /// Writes tune.json, tables and report of that experiment. Returns the report's path.
    std::string write_results(const std::string& tune_json);

    /// Seconds since the beginning, and those of the runs that were stored before.
    double used() const;
    /// Whether the method leaves out nothing of the scene and has no bias.
    bool is_unbiased(const MethodLabel& label) const;
    /// Effects and light that the method leaves out in this scene.
    const LeftOut& left_out(const MethodLabel& label) const;

private:
    std::string experiment_text(const std::vector<MethodLabel>& labels, int seeds) const;
    void open(const std::vector<MethodLabel>& labels, int seeds);
    WorkCell cell_of(const Wanted& wanted) const;

    const TuneFile& file_;
    const ExperimentScene& scene_;
    const RunOptions& options_;
    std::unique_ptr<RunSession> session_;
    bool is_experiment_ = false;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double stored_seconds_ = 0;  ///< of runs before an interruption
};

}  // namespace gib
