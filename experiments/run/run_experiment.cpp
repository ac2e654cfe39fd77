#include "experiments/run/run_experiment.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/run/cell_queue.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>

namespace gib {

namespace {

constexpr int exit_interrupted = 130;

void require_utf8(const std::string& text, const char* what) {
    try {
        static_cast<void>(nlohmann::json(text).dump());
    } catch (const nlohmann::json::exception&) {
        throw InputError(fmt::format("{} is not UTF-8, as the records of a run have to be", what));
    }
}

}  // namespace

void require_utf8_names(const std::string& command_line) {
    require_utf8(command_line, "the command line");
    require_utf8(std::filesystem::current_path().string(), "the current folder's name");
}

int run_experiment(const RunOptions& options, std::ostream& out) {
    require_utf8_names(options.command_line);
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
