#pragma once
// The only timed rendering loop: it measures one cell (a scene, a method, a seed) and charges it with the wall-clock
// time of `start` and `advance` and with nothing else.

#include "experiments/plan/experiment_file.h"
#include "methods/method.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

class CheckpointFilter;

/// A cell's state after some passes.
struct Checkpoint {
    std::uint32_t passes = 0;  ///< done so far, which is the number of samples a pixel
    double seconds = 0;        ///< [s] charged so far, including the preparation
    RunCounts counts;
    double peak_rss_mib = 0;  ///< largest resident set of this process so far [MiB]
};

struct MeasureWork {
    const Scene& scene;
    const Method& method;
    std::uint64_t seed;
    std::uint32_t spp;  ///< passes to make at most
    Budget budget;
    bool only_last = false;  ///< the image at the end is the only checkpoint
    /// Filters the images; null: they stay as they are. A checkpoint is charged with its features and its own filtering
    /// alone.
    CheckpointFilter* filter = nullptr;
};

struct Measurement {
    double load_seconds = 0;     ///< [s] of reading the scene; whoever reads it sets them
    double prepare_seconds = 0;  ///< wall-clock time of `start` [s]
    std::vector<Checkpoint> checkpoints;
    std::vector<StageTimes::Stage> stages;  ///< the last one, `other`, is the charged time outside all stages
    bool converged = false;
    double processor_seconds = 0;  ///< [s] for which this process' threads ran meanwhile
    double waiting_seconds = 0;    ///< [s] for which they were ready to run, but others had the processors
    std::vector<std::pair<std::string, std::string>> facts;  ///< (name, value), see Run::facts()
};

/// Receives each checkpoint with its image, which is its own; its time is not charged.
using CheckpointSink = std::function<void(const Checkpoint&, ComponentImages&&)>;
/// Is called after each pass; its time is not charged. It may throw to stop the measurement.
using PassObserver = std::function<void(std::uint32_t passes, double seconds)>;

/// How far the preparation or the current pass has come.
struct OngoingWork {
    bool preparing;
    std::uint32_t passes;  ///< completed so far
    std::string_view stage;
    double fraction;  ///< share of the stage that is done
    double seconds;   ///< [s] since the preparation began; once it is done, since the first pass began
};
/// Is called a few times a second, from any thread but never from two at once. It has to be quick:
/// its time is charged.
using WorkObserver = std::function<void(const OngoingWork&)>;

/// Whether there is a checkpoint after this number of passes: 1, 2, 3, 4, 6, 8, 12, 16, 24, ..., that is, two in each
/// octave and the same ones in every replicate.
bool is_checkpoint(std::uint32_t passes);

/// Runs passes until `spp`, the budget or convergence ends the cell. At least one pass completes, and the last pass
/// is a checkpoint. A filter may need more passes, which then complete; throws RunError if spp or budget allow fewer.
Measurement measure(const MeasureWork& work, const CheckpointSink& sink, const PassObserver& observer = {},
                    const WorkObserver& work_observer = {});

/// The samples a pixel of a scene that does not say how many.
inline constexpr int default_sample_count = 16;

/// The number of passes that a cell makes at most: the label's spp, else the scene's sample count or its default.
std::uint32_t last_pass(const ParameterValues& values, std::optional<int> sample_count);

}  // namespace gib
