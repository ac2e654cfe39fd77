#include "experiments/slurm/submit.h"

#include "common/core/reject.h"
#include "experiments/run/cell_queue.h"
#include "experiments/slurm/slurm_jobs.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <tuple>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// The work (MadeBatch::work) that the job which adds up batches does itself: 5 to 10 s on two cores, less than it
/// takes a cluster to start another array job.
constexpr double most_work_of_merge = 1e8;

/// Only one process at a time submits jobs for a folder.
FileLock lock_jobs(const JobFolder& folder) {
    return lock_reference(folder.path() + "/jobs.json", [](const std::string& owner) {
        std::cerr << fmt::format("{} is submitting jobs; waiting until it has ended\n", owner);
    });
}

/// Submits jobs of a run and notes them in its folder.
class Submission {
public:
    Submission(JobFolder folder, SlurmJobs jobs, std::string program, int threads, std::ostream& out)
        : folder_(std::move(folder)),
          jobs_(std::move(jobs)),
          program_(std::move(program)),
          threads_(threads),
          largest_(std::min(jobs_.most_tasks, largest_array())),
          out_(out) {}

    std::size_t most_tasks() const { return largest_; }

    std::uint64_t submit(const char* kind, const std::string& plan, std::size_t tasks,
                         const std::vector<std::uint64_t>& after) {
        const std::uint64_t number = submit_job({.name = fmt::format("gibench-{}", kind),
                                                 .command = {program_, "run-task", plan, kind},
                                                 .tasks = tasks,
                                                 .cpus = threads_,
                                                 .log_folder = folder_.path(),
                                                 .after = after,
                                                 .user_options = jobs_.user_options});
        jobs_.jobs.push_back({kind, number, plan});
        folder_.write(jobs_);  // at once, so that a job is known even if the next one is refused
        out_ << fmt::format("{}: job {}{}{}\n", kind, number,
                            tasks > 0 ? fmt::format(", {} task{}", tasks, tasks == 1 ? "" : "s") : "",
                            after.empty() ? "" : fmt::format(", after {}", fmt::join(after, ", ")));
        return number;
    }

    /// The jobs that make these batches and add them up. Returns the number of the last one.
    std::uint64_t submit_batches(RunPlan plan, const std::vector<PlannedBatch>& missing) {
        plan.batches = shared_out(missing, largest_);
        plan.cells.clear();
        const std::string path = folder_.add_plan(plan);
        const std::uint64_t batches = submit(batches_job, path, plan.batches.size(), {});
        return submit(merge_job, path, 0, {batches});
    }

private:
    JobFolder folder_;
    SlurmJobs jobs_;
    std::string program_;
    int threads_;
    std::size_t largest_;
    std::ostream& out_;
};

std::string path_of_program(const std::string& program) {
    return fs::is_symlink(program) ? fs::read_symlink(program).string() : fs::absolute(program).string();
}

int exit_code(bool complete, const ExperimentRun& run) {
    return !complete ? exit_interrupted : run.failures().empty() ? 0 : exit_failed;
}

bool is_same(const PlannedBatch& a, const PlannedBatch& b) {
    return std::tie(a.scene, a.batch.maker, a.batch.number, a.batch.passes, a.batch.passes_before) ==
           std::tie(b.scene, b.batch.maker, b.batch.number, b.batch.passes, b.batch.passes_before);
}

int merge(const RunOptions& options, ExperimentRun& run, const RunPlan& plan, std::ostream& out) {
    const auto missing = run.advance_references(most_work_of_merge);
    run.write_index();
    if (missing.empty()) return exit_code(true, run);
    // A batch that its task was to make and that is not there has failed or was cancelled.
    std::size_t lost = 0;
    for (const auto& task : plan.batches)
        for (const PlannedBatch& batch : task)
            lost += static_cast<std::size_t>(std::count_if(
                missing.begin(), missing.end(), [&](const PlannedBatch& other) { return is_same(batch, other); }));
    if (lost > 0)
        throw RunError(
            fmt::format("{} batches of references were not made; the command that submitted this run makes "
                        "them again",
                        lost));
    const JobFolder folder(plan.out);
    const FileLock lock = lock_jobs(folder);
    SlurmJobs jobs = folder.read();
    const auto waiting = active_jobs(jobs).numbers(cells_job);
    forget_own_job();
    Submission submission(folder, std::move(jobs), path_of_program(options.program), plan.threads, out);
    const std::uint64_t last = submission.submit_batches(plan, missing);
    for (const std::uint64_t job : waiting)
        try {
            set_dependency(job, last);
        } catch (const RunError& error) {  // cells of an earlier submission may run already
            out << fmt::format("job {} does not wait for the references: {}\n", job, error.what());
        }
    return 0;
}

int report(ExperimentRun& run, const RunPlan& plan, std::ostream& out) {
    const FileLock lock = lock_result_folder(plan.out);
    const auto states = run.states();
    out << "Report: " << run.write_results() << "\n";
    const auto complete = static_cast<std::size_t>(
        std::count_if(states.begin(), states.end(), [](const CellState& state) { return state.complete; }));
    if (complete == states.size()) return 0;
    throw RunError(fmt::format("{} of {} cells are not complete; `gibench status {}` lists them",
                               states.size() - complete, states.size(), plan.out));
}

}  // namespace

int submit_run(RunOptions options, const SlurmOptions& slurm, std::ostream& out) {
    require_slurm();
    options.shared = true;
    ExperimentRun run(options);
    const JobFolder folder(run.folder().path());
    ResultFolder::make(folder.path());
    const FileLock lock = lock_jobs(folder);
    SlurmJobs jobs = folder.read();
    jobs.user_options = slurm.user_options;
    jobs.most_tasks = slurm.most_tasks;
    const ActiveJobs active = active_jobs(jobs);
    if (options.fresh && !active.tasks.empty())
        reject({}, "--fresh would delete what the jobs of '{}' measure: wait for them or cancel them",
               options.out ? *options.out : folder.path());
    if (options.fresh) run.forget_cells();

    RunPlan plan = run.plan();
    Submission submission(folder, std::move(jobs), path_of_program(options.program), plan.threads, out);
    std::vector<std::uint64_t> references = active.numbers(merge_job);
    if (references.empty()) {
        const auto missing = run.advance_references(0);
        run.write_index();
        for (const std::string& failure : run.failures())
            std::cerr << "failed: " << failure << "\n";
        if (!missing.empty()) references.push_back(submission.submit_batches(plan, missing));
    }

    std::vector<CellPlace> cells;
    const auto elsewhere = active_cells(active);
    std::size_t complete = 0;
    for (const CellState& state : run.states()) {
        if (state.complete) ++complete;
        else if (elsewhere.count(state.name) == 0) cells.push_back(state.place);
    }
    out << fmt::format("cells: {} complete, {} in jobs already, {} to be submitted\n", complete, elsewhere.size(),
                       cells.size());
    std::vector<std::uint64_t> before = active.numbers(cells_job);
    if (!cells.empty()) {
        plan.cells = shared_out(cells, submission.most_tasks());
        before.push_back(submission.submit(cells_job, folder.add_plan(plan), plan.cells.size(), references));
    }
    if (!cells.empty() || active.numbers(report_job).empty()) {
        plan.cells.clear();
        submission.submit(report_job, folder.add_plan(plan), 0, before.empty() ? references : before);
    }
    out << fmt::format("`gibench status {}` says how far they have come\n", run.folder().path());
    return run.failures().empty() ? 0 : exit_failed;
}

int run_task(const std::string& plan_file, const std::string& kind, std::ostream& out) {
    const InterruptGuard guard;
    const RunPlan plan = read_plan(plan_file);
    RunOptions options;
    options.shared = true;
    ExperimentRun run(options, plan);
    const std::size_t task = own_array_index();
    if (kind == batches_job) return exit_code(run.make_batches(plan.batches.at(task)), run);
    if (kind == cells_job) return exit_code(run.measure_cells(plan.cells.at(task)), run);
    if (kind == merge_job) return merge(options, run, plan, out);
    if (kind == report_job) return report(run, plan, out);
    reject({}, "there is no job of the kind '{}'", kind);
}

void require_no_jobs(const RunOptions& options) {
    const std::string folder =
        options.out ? *options.out : result_folder_of(fs::path(options.experiment).stem().string());
    const JobFolder jobs(folder);
    if (!jobs.exists()) return;
    try {
        if (active_jobs(jobs.read()).tasks.empty()) return;
    } catch (const RunError&) {
        return;  // no Slurm here that could run them
    }
    reject({}, "jobs of Slurm are working in '{}': wait until they have ended (`gibench status {}`), or cancel them",
           folder, folder);
}

}  // namespace gib
