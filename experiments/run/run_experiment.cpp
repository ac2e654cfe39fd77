#include "experiments/run/run_experiment.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/hard_cases/hard_case_file.h"
#include "experiments/hard_cases/hard_case_run.h"
#include "experiments/run/cell_queue.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>

namespace gib {

namespace {

constexpr int exit_interrupted = 130;

/// Throws InputError if the experiment exists but is not a regular file: it is read several times, for hard cases by
/// other processes too, and a pipe would be empty after the first time. A file that cannot be read gives an error
/// when it is read.
void require_regular_file(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw InputError({path, 0, 0}, "an experiment has to be a regular file");
}

}  // namespace

int run_experiment(const RunOptions& options, std::ostream& out) {
    require_regular_file(options.experiment);
    if (holds_hard_cases(options.experiment)) return run_hard_cases(options, out);
    const InterruptGuard guard;
    ExperimentRun run(options);
    const bool complete = run.measure();
    const std::string report = run.write_results();
    if (!complete) {
        std::cerr << fmt::format("interrupted: what is complete is in {}; the same command{} goes on from there\n",
                                 run.folder().path(), options.fresh ? " without --fresh" : "");
        return exit_interrupted;
    }
    out << read_file(run.folder().file("table.md")) << "\nReport: " << report << "\n";
    if (run.failures().empty()) return 0;
    std::cerr << fmt::format("{} failed:\n", run.failures().size());
    for (const auto& failure : run.failures())
        std::cerr << "  " << failure << "\n";
    return 1;
}

}  // namespace gib
