#include "experiments/measuring/measure.h"

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

std::vector<StageTimes::Stage> with_other(std::vector<StageTimes::Stage> stages, double charged) {
    double staged = 0;
    for (const auto& stage : stages)
        staged += stage.seconds;
    stages.push_back({"other", std::max(0.0, charged - staged)});
    return stages;
}

}  // namespace

bool is_checkpoint(std::uint32_t passes) {
    if (passes == 0) return false;
    while (passes % 2 == 0)
        passes /= 2;
    return passes == 1 || passes == 3;
}

Measurement measure(const CellWork& work, const CheckpointSink& sink, const PassObserver& observer,
                    const WorkObserver& work_observer) {
    const std::uint32_t last = std::max(1u, std::min(work.spp, work.budget.passes.value_or(work.spp)));
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
    const auto run = work.method.start(work.scene, work.seed, stages);
    double charged = start_watch.seconds();
    result.prepare_seconds = charged;
    preparing = false;
    double peak = 0;

    for (std::uint32_t pass = 0;; ++pass) {
        const Stopwatch watch;
        const Progress progress = run->advance(pass);
        charged += watch.seconds();

        passes = pass + 1;
        result.converged = progress == Progress::converged;
        const bool ends =
            result.converged || passes >= last || (work.budget.seconds && charged >= *work.budget.seconds);
        if (ends || (!work.only_last && is_checkpoint(passes))) {
            // The peak is read before the image is taken and reset after the image is stored, because copies for the
            // driver are not the method's memory.
            peak = std::max(peak, peak_rss_mib());
            result.checkpoints.push_back(
                {.passes = passes, .seconds = charged, .counts = run->counts(), .peak_rss_mib = peak});
            sink(result.checkpoints.back(), run->image());
            reset_peak_rss();
        }
        if (observer) observer(passes, charged);
        if (ends) break;
    }
    const ProcessorTime after = processor_time();
    result.processor_seconds = after.running - before.running;
    result.waiting_seconds = after.waiting - before.waiting;
    result.facts = run->facts();
    result.stages = with_other(stages.stages(), charged);
    return result;
}

std::uint32_t last_pass(const ParameterValues& values, std::optional<int> sample_count) {
    if (values.given("spp")) return static_cast<std::uint32_t>(values.integer("spp"));
    return static_cast<std::uint32_t>(sample_count.value_or(16));
}

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

void reset_peak_rss() {
    // If the kernel has no such file, the write fails and the peak includes what storing the checkpoints took.
    std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_rss_mib() {
    // getrusage would not do: after exec, its ru_maxrss still holds the size of the process that forked.
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
    return 0;
}

}  // namespace gib
