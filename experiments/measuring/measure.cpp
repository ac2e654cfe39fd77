#include "experiments/measuring/measure.h"

#include "common/core/error.h"
#include "experiments/filter/checkpoint_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

namespace gib {

namespace {

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<StageTimes::Stage> with_other(std::vector<StageTimes::Stage> stages, double filtering, double charged) {
    double staged = 0;
    for (const auto& stage : stages)
        staged += stage.seconds;
    if (filtering > 0) stages.push_back({"filter", filtering});
    stages.push_back({"other", std::max(0.0, charged - staged)});
    return stages;
}

/// Processor and waiting time of the threads of this process so far, as the scheduler counts them.
struct ProcessorTime {
    double running = 0, waiting = 0;  ///< [s], summed over threads; 0 if the system does not say
};
ProcessorTime processor_time() {
    ProcessorTime sum;
    std::error_code error;  // a thread may end while the folder is read
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task", error)) {
        double running = 0, waiting = 0;  // [ns]
        if (std::ifstream(thread.path() / "schedstat") >> running >> waiting) {
            sum.running += 1e-9 * running;
            sum.waiting += 1e-9 * waiting;
        }
    }
    return sum;
}

/// Makes peak_rss_mib() start again from the memory in use now.
void reset_peak_rss() {
    // If the kernel has no such file, the write fails and the peak includes what storing the checkpoints took.
    std::ofstream("/proc/self/clear_refs") << "5";
}

/// The largest resident set of this process so far [MiB]; 0 if the system does not say.
double peak_rss_mib() {
    // getrusage would not do: after exec, its ru_maxrss still holds the size of the process that forked.
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
    return 0;
}

/// Makes the checkpoints of a measurement.
class Checkpoints {
public:
    Checkpoints(const MeasureWork& work, const CheckpointSink& sink, Measurement& result)
        : work_(work), sink_(sink), result_(result) {}

    /// The time of the last filtering [s], which only its own checkpoint is charged with.
    double filtering() const { return filtering_; }

    /// `charged` [s] is that of the passes so far; `is_last`: the image is one of the checkpoints in any case.
    void take(const Run& run, std::uint32_t passes, double charged, bool is_last) {
        // The peak is read before the image is taken and reset after the image is stored, because copies for the
        // driver are not the method's memory. Those that a filter works on are.
        peak_ = std::max(peak_, peak_rss_mib());
        ComponentImages image = run.image();
        if (work_.filter) work_.filter->keep(passes, image);
        const bool is_filtered = work_.filter && passes >= work_.filter->least_passes();
        if (is_last || (!work_.only_last && (is_filtered || !work_.filter))) {
            if (is_filtered) image = filtered(passes, image);
            result_.checkpoints.push_back(
                {.passes = passes, .seconds = charged + filtering_, .counts = run.counts(), .peak_rss_mib = peak_});
            sink_(result_.checkpoints.back(), std::move(image));
        }
        reset_peak_rss();
    }

private:
    ComponentImages filtered(std::uint32_t passes, const ComponentImages& image) {
        const Stopwatch watch;
        ComponentImages result = work_.filter->filtered(passes, image);
        filtering_ = watch.seconds();
        peak_ = std::max(peak_, peak_rss_mib());
        return result;
    }

    const MeasureWork& work_;
    const CheckpointSink& sink_;
    Measurement& result_;
    double filtering_ = 0, peak_ = 0;
};

}  // namespace

bool is_checkpoint(std::uint32_t passes) {
    if (passes == 0) return false;
    while (passes % 2 == 0)
        passes /= 2;
    return passes == 1 || passes == 3;
}

Measurement measure(const MeasureWork& work, const CheckpointSink& sink, const PassObserver& observer,
                    const WorkObserver& work_observer) {
    const std::uint32_t last = std::max(1u, std::min(work.spp, work.budget.passes.value_or(work.spp)));
    const std::uint32_t least = work.filter ? work.filter->least_passes() : 1;
    if (last < least) throw RunError(fmt::format("too few passes: the filter needs {} at least", least));
    Measurement result;
    StageTimes stages;
    const ProcessorTime before = processor_time();
    const Stopwatch start_watch;
    bool preparing = true;
    std::uint32_t passes = 0;
    if (work_observer)
        stages.listen([&](std::string_view stage, double fraction) {
            const double prepared = result.prepare_seconds;
            work_observer({.preparing = preparing,
                           .passes = passes,
                           .stage = stage,
                           .fraction = fraction,
                           .seconds = start_watch.seconds() - prepared});
        });
    if (work.filter) work.filter->prepare(stages);
    const auto run = work.method.start(work.scene, work.seed, stages);
    double charged = start_watch.seconds();
    result.prepare_seconds = charged;
    preparing = false;
    Checkpoints checkpoints(work, sink, result);

    for (std::uint32_t pass = 0;; ++pass) {
        const Stopwatch watch;
        const Progress progress = run->advance(pass);
        charged += watch.seconds();

        passes = pass + 1;
        result.converged = progress == Progress::converged;
        const bool ends =
            result.converged || passes >= last ||
            (passes >= least && work.budget.seconds && charged + checkpoints.filtering() >= *work.budget.seconds);
        if (ends || (is_checkpoint(passes) && (work.filter || !work.only_last))) {
            checkpoints.take(*run, passes, charged, ends);
        }
        if (observer) observer(passes, charged);
        if (ends) break;
    }
    const ProcessorTime after = processor_time();
    result.processor_seconds = after.running - before.running;
    result.waiting_seconds = after.waiting - before.waiting;
    result.facts = run->facts();
    result.stages = with_other(stages.stages(), checkpoints.filtering(), charged);
    return result;
}

std::uint32_t last_pass(const ParameterValues& values, std::optional<int> sample_count) {
    if (values.given("spp")) return static_cast<std::uint32_t>(values.integer("spp"));
    return static_cast<std::uint32_t>(sample_count.value_or(default_sample_count));
}

}  // namespace gib
