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
void say_what_is_kept(const RunSession& run, const std::vector<WorkCell>& cells, ProgressLine& progress) {
    std::size_t kept = 0, replaced = 0, of_other_builds = 0;
    for (const WorkCell& cell : cells) {
        if (cell.record) {
            ++kept;
            of_other_builds += cell.record->build != run.setup.build;
        } else if (!cell.damage.empty()) {
            progress.message(fmt::format("warning: {}; the cell is done again", cell.damage));
        } else if (std::filesystem::exists(run.folder.cell_record(cell.name))) {
            ++replaced;
        }
    }
    if (kept > 0) progress.note(fmt::format("cells complete already, not done again: {}", kept));
    if (replaced > 0)
        progress.note(
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
        auto cells = run.list.with_records(run.folder);
        std::erase_if(cells, [&](const WorkCell& cell) { return run.references.has_failed(cell.scene); });
        say_what_is_kept(run, cells, run.log.progress);
        run.write_index();
        run_cells(left_of(cells), run.runner, run.log.progress);
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

/// Throws InputError if a folder cannot be made or written in, or RunError on a full disk; makes none.
void require_possible(const std::string& folder) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (fs::is_directory(folder, ignored)) return require_writable(folder);
    fs::path there = fs::absolute(folder);
    while (!fs::exists(there, ignored) && there.has_relative_path())
        there = there.parent_path();
    if (!fs::is_directory(there, ignored)) reject({}, "cannot make the folder '{}': a file is in the way", folder);
    try {
        require_writable(there.string());
    } catch (const InputError& error) {
        reject({}, "cannot make the folder '{}': {}", folder, error.what());
    }
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

void check_out(const RunOptions& options) {
    namespace fs = std::filesystem;
    if (!options.out) return;
    require_possible(*options.out);
    if (options.quiet) return;
    fs::path folder = fs::absolute(*options.out).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    if (const fs::path parent = folder.parent_path(); !fs::exists(parent))
        std::cerr << fmt::format("note: there is no folder '{}'; it is made\n", parent.string());
}

int run_experiment(const RunOptions& options, std::ostream& out) {
    const InterruptGuard guard;
    check_out(options);
    if (options.share) return run_share(options, out);
    RunSession run(checked_setup(load_experiment(options.experiment), options), options, FolderUse::alone);
    const bool complete = measure(run, options.fresh);
    // Without a failure, cells are lacking only if a share that has begun meanwhile has taken them.
    const std::string left = run.log.failures.empty() ? run.what_is_left() : "";
    const std::string report = run.write_results();
    if (!complete) return interrupted(run, options);
    if (!options.quiet)
        out << fmt::format("{}Tables: {}\nReport: {}\n", run.verdict.empty() ? "" : run.verdict + "\n",
                           run.folder.file("table.md"), report);
    if (!left.empty()) throw RunError(left);
    return run.log.exit_code();
}

}  // namespace gib
