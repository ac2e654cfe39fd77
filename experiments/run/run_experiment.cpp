#include "experiments/run/run_experiment.h"

#include "common/core/reject.h"
#include "experiments/run/run_session.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>

namespace gib {

namespace {

/// Says how many cells are complete already, and why others are done again.
void say_what_is_kept(const RunSession& run, const std::vector<CellState>& states, ProgressLine& progress) {
    std::size_t kept = 0, replaced = 0, of_other_builds = 0;
    for (const CellState& state : states) {
        if (state.record) {
            ++kept;
            of_other_builds += state.record->build != run.setup.build;
        } else if (!state.damage.empty()) {
            progress.message(fmt::format("warning: {}; the cell is done again", state.damage));
        } else if (std::filesystem::exists(run.folder.cell_folder(state.cell->name) + "/cell.json")) {
            ++replaced;
        }
    }
    if (kept > 0) progress.message(fmt::format("cells complete already, not done again: {}", kept));
    if (replaced > 0)
        progress.message(
            fmt::format("cells measured before with another scene file, reference, budget, epsilon, command or number "
                        "of threads, done again: {}",
                        replaced));
    if (of_other_builds > 0)
        progress.message(fmt::format(
            "warning: {} of them were measured by another build of gibench; --fresh does them again", of_other_builds));
}

/// Measures the selected cells that are left. Returns false if the user interrupted it.
bool measure(RunSession& run, bool is_fresh) {
    if (is_fresh) run.forget_cells();
    try {
        run.make_references();
        auto states = run.list.states(run.folder);
        std::erase_if(states, [&](const CellState& s) { return run.references.has_failed(s.cell->scene); });
        if (!run.log.progress.quiet) say_what_is_kept(run, states, run.log.progress);
        run.write_index();
        run_cells(left_of(states), run.runner, run.log.progress);
    } catch (const Interrupted&) {
        return false;
    }
    return true;
}

int interrupted(const RunSession& run, const RunOptions& options) {
    std::cerr << fmt::format("interrupted: what is complete is in {}; the same command{} goes on from there\n",
                             run.folder.path(), options.fresh ? " without --fresh" : "");
    return exit_interrupted;
}

/// Says before anything is loaded that the folder of --out will be made below one that is not there, which may be mistyped.
void tell_new_folders(const RunOptions& options) {
    namespace fs = std::filesystem;
    if (!options.out || options.quiet) return;
    fs::path folder = fs::absolute(*options.out).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    if (const fs::path parent = folder.parent_path(); !fs::exists(parent))
        std::cerr << fmt::format("note: there is no folder '{}'; it is made\n", parent.string());
}

int run_share(const RunOptions& options, std::ostream& out) {
    RunSession run(checked_setup(load_experiment(options.experiment), options), options, FolderUse::shared);
    run.list.select(*options.share);
    if (!measure(run, options.fresh)) return interrupted(run, options);
    out << fmt::format(
        "share {} of {}: {} cells; the same command without --share makes the tables when all are done\n",
        options.share->index, options.share->count, run.list.selected().size());
    return run.log.exit_code();
}

}  // namespace

int run_experiment(const RunOptions& options, std::ostream& out) {
    const InterruptGuard guard;
    tell_new_folders(options);
    if (options.share) return run_share(options, out);
    RunSession run(checked_setup(load_experiment(options.experiment), options), options, FolderUse::alone);
    const bool complete = measure(run, options.fresh);
    const std::string report = run.write_results();
    if (!complete) return interrupted(run, options);
    if (!options.quiet)
        out << fmt::format("{}Tables: {}\nReport: {}\n", run.verdict.empty() ? "" : run.verdict + "\n",
                           run.folder.file("table.md"), report);
    return run.log.exit_code();
}

}  // namespace gib
