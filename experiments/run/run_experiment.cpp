#include "experiments/run/run_experiment.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/run/cell_queue.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <iostream>

namespace gib {

int run_experiment(const RunOptions& options, std::ostream& out) {
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
