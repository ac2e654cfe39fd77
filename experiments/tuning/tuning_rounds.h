#pragma once
// The runs of a tuning: each round is an experiment in a folder of its own.

#include "experiments/results/result_folder.h"
#include "experiments/tuning/tune_options.h"
#include "experiments/tuning/tuning_clock.h"

#include <string>
#include <vector>

namespace gib {

class TuningRounds {
public:
    /// Loads the scene once, for its hash. `reference_seconds` limits the reference, whose standard error is to be a quarter
    /// of the target error.
    TuningRounds(const TuneOptions& options, std::string name, std::string folder, double target,
                 double reference_seconds);

    struct Request {
        std::string name;
        std::vector<MethodLabel> labels = {};
        double budget = 0;    ///< seconds of each run
        int seeds = 1;        ///< 1 to this
        int first_seed = 1;   ///< first seed whose cells are returned
        double deadline = 0;  ///< used() after which no run begins
        bool has_report = false;
    };
    struct Round {
        std::vector<std::vector<Cell>> cells;  ///< by label; none of a label that failed or was left out
        bool is_cut = false;                   ///< whether runs were left out for lack of time
    };
    /// Measures what is not stored yet. Throws Interrupted.
    Round measured(const Request& request);

    double used() const { return clock_.used(); }
    /// Seconds that a run of the last round took besides those that it is charged: its process, loading, the comparison with
    /// the reference. Before the second round, a guess.
    double besides() const { return besides_; }
    const std::string& folder() const { return folder_; }
    const std::string& scene() const { return scene_; }

private:
    std::string experiment_text(const Request& request) const;
    Round run(const Request& request);

    const TuneOptions& options_;
    std::string name_, folder_, scene_, setup_;
    double target_, reference_seconds_;
    TuningClock clock_;
    double besides_ = 0.6;  // measured at 256 x 256 pixels on two cores
};

}  // namespace gib
