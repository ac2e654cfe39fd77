#pragma once
// The driver's only rendering loop: one cell (a scene, a method, a seed), charged with the wall-clock time of `start`
// and `advance` and of nothing else.

#include "experiments/plan/experiment_file.h"
#include "methods/method.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// A cell's state after some passes.
struct Checkpoint {
    std::uint32_t passes = 0;  ///< done so far; samples a pixel
    double seconds = 0;        ///< charged so far, the preparation included
    RunCounts counts;
    double peak_rss_mib = 0;  ///< of this process so far [MiB]
};

struct CellWork {
    const Scene& scene;
    const Method& method;
    std::uint64_t seed;
    std::uint32_t spp;  ///< the last pass
    Budget budget;
};

struct Measurement {
    double prepare_seconds = 0;  ///< of `start`
    std::vector<Checkpoint> checkpoints;
    std::vector<StageTimes::Stage> stages;  ///< the last is `other`: charged and not staged
    bool converged = false;
    std::vector<std::pair<std::string, std::string>> facts;  ///< what the run says of itself at the end
};

/// Sees each checkpoint with its image; not charged.
using CheckpointSink = std::function<void(const Checkpoint&, const ComponentImages&)>;
/// Called after each pass; not charged. May throw to stop.
using PassObserver = std::function<void(std::uint32_t passes, double seconds)>;

/// Work that goes on, in the preparation or in a pass.
struct OngoingWork {
    bool preparing;
    std::uint32_t passes;  ///< done before
    std::string_view stage;
    double fraction;  ///< of the stage
    double seconds;   ///< since the preparation, or the first pass, began
};
/// Told a few times a second, from any thread but never from two at once; charged, so it should be quick.
using WorkObserver = std::function<void(const OngoingWork&)>;

/// 1, 2, 3, 4, 6, 8, 12, 16, 24, ...: two to the octave, the same in every replicate.
bool is_checkpoint(std::uint32_t passes);

/// Runs until spp, the budget or convergence. At least one pass completes, and the last pass is a checkpoint.
Measurement measure(const CellWork& work, const CheckpointSink& sink, const PassObserver& observer = {},
                    const WorkObserver& work_observer = {});

/// The label's spp, else the scene's sample count, else 16.
std::uint32_t last_pass(const ParameterValues& values, std::optional<int> sample_count);

/// The largest resident set of this process so far [MiB]; 0 if the system does not say.
double peak_rss_mib();
/// Starts the measurement of peak_rss_mib again from the memory in use now.
void reset_peak_rss();

}  // namespace gib
