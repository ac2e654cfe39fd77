#include "experiments/slurm/submit.h"

#include "common/core/reject.h"
#include "experiments/measuring/child_request.h"
#include "experiments/run/run_session.h"
#include "experiments/slurm/slurm_jobs.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <set>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// The work (MadeBatch::work) that the job which adds up batches does itself: 5 to 10 s on two cores, less than it
/// takes a cluster to start another array job.
constexpr double most_work_of_job = 1e8;

/// Submits jobs of a run and notes them in its folder. Only one process at a time does.
class Submission {
public:
    Submission(const RunSession& run, const RunOptions& options, const SlurmOptions& slurm, std::ostream& out)
        : run_(run), options_(options), slurm_(slurm), out_(out), folder_(run.folder.path()) {
        ResultFolder::make(folder_.path());
        lock_.emplace(lock_reference(folder_.path() + "/jobs.json", [](const std::string& owner) {
            std::cerr << fmt::format("{} is submitting jobs; waiting until it has ended\n", owner);
        }));
        jobs_ = folder_.read();
        active_.emplace(jobs_);
        largest_ = std::min(slurm.most_tasks, largest_array());
        forget_own_job();
    }

    /// The tasks of earlier submissions that have not ended, without this process.
    const ActiveJobs& active() const { return *active_; }

    /// The jobs that make these batches and add them up.
    void submit_batches(const std::vector<PlannedBatch>& missing) {
        const std::string file = folder_.add_batches(missing);
        std::vector<std::size_t> tasks(std::min(missing.size(), largest_));
        std::iota(tasks.begin(), tasks.end(), std::size_t{0});
        const std::uint64_t batches = submit({batches_job, file}, {}, {.tasks = tasks, .shares = tasks.size()});
        submit({references_job, file}, {batches}, {});
    }

    /// The jobs for cells that are not complete and in no job.
    void submit_cells() {
        const auto elsewhere = active_->cells();
        const auto cells = run_.list.with_records(run_.folder);
        Array array{.shares = std::min(cells.size(), largest_)};
        std::set<std::size_t> tasks;
        std::size_t complete = 0, wanted = 0;
        for (const WorkCell& cell : cells) {
            if (cell.record) ++complete;
            else if (elsewhere.count(cell.name) == 0) {
                ++wanted;
                tasks.insert(array.cells.size() % array.shares);
            }
            array.cells.push_back(cell.name);
        }
        array.tasks.assign(tasks.begin(), tasks.end());
        out_ << fmt::format("cells: {} complete, {} in jobs already, {} to be submitted\n", complete,
                            cells.size() - complete - wanted, wanted);
        std::set<std::uint64_t> before = active_->numbers(cells_job);
        if (wanted > 0) before.insert(submit({cells_job}, {}, array));
        if (wanted > 0 || active_->numbers(report_job).empty()) submit({report_job}, before, {});
    }

private:
    /// An array job that runs the shares `tasks` of `shares`; no tasks: it is no array.
    struct Array {
        std::vector<std::size_t> tasks = {};
        std::size_t shares = 0;
        std::vector<std::string> cells = {};  ///< SubmittedJob::cells
    };

    /// `job` is what run_job() takes. Returns the number.
    std::uint64_t submit(const std::vector<std::string>& job, const std::set<std::uint64_t>& after,
                         const Array& array) {
        const std::string& kind = job.front();
        auto command = command_of_run();
        if (array.shares > 0)
            command.insert(command.end(), {"--share", fmt::format("{}/{}", task_index, array.shares)});
        command.push_back("--job");
        command.insert(command.end(), job.begin(), job.end());
        const std::uint64_t number = submit_job({.name = job_name(kind),
                                                 .command = command,
                                                 .tasks = array.tasks,
                                                 .cpus = run_.setup.threads,
                                                 .log_folder = folder_.path(),
                                                 .after = {after.begin(), after.end()},
                                                 .user_options = slurm_.user_options});
        jobs_.push_back({kind, number, array.shares, array.cells});
        folder_.write(jobs_);  // at once, so that a job is known even if the next one is refused
        out_ << fmt::format("{}: job {}{}{}\n", kind, number,
                            array.tasks.empty() ? "" : fmt::format(", tasks: {}", array.tasks.size()),
                            after.empty() ? "" : fmt::format(", after {}", fmt::join(after, ", ")));
        return number;
    }

    /// The program with the options of the run.
    std::vector<std::string> command_of_run() const {
        std::vector<std::string> command = {fs::read_symlink(own_program).string(),
                                            "run",
                                            options_.experiment,
                                            "--out",
                                            run_.folder.path(),
                                            "--threads",
                                            std::to_string(run_.setup.threads),
                                            "--tasks",
                                            std::to_string(slurm_.most_tasks)};
        if (!slurm_.sbatch.empty()) command.insert(command.end(), {"--sbatch", slurm_.sbatch});
        if (options_.seeds) command.insert(command.end(), {"--seeds", std::to_string(*options_.seeds)});
        if (!options_.only.empty()) command.insert(command.end(), {"--only", options_.only});
        return command;
    }

    const RunSession& run_;
    const RunOptions& options_;
    const SlurmOptions& slurm_;
    std::ostream& out_;
    JobFolder folder_;
    std::optional<FileLock> lock_;
    std::vector<SubmittedJob> jobs_;
    std::optional<ActiveJobs> active_;
    std::size_t largest_ = 1;
};

/// Throws RunError if batches that tasks were to make are still missing: the tasks have failed or were cancelled.
void require_made(const std::vector<PlannedBatch>& made, const std::vector<PlannedBatch>& missing) {
    const auto lost =
        std::ranges::count_if(made, [&](const PlannedBatch& batch) { return std::ranges::count(missing, batch) > 0; });
    if (lost > 0)
        throw RunError(
            fmt::format("{} batches of references were not made; the command that submitted this run makes "
                        "them again",
                        lost));
}

/// Brings the references on their way, each by at most so much work of this process, and submits what comes next.
/// `made`: batches that jobs have made.
void go_on(RunSession& run, Submission& submission, double most_own_work, const std::vector<PlannedBatch>& made = {}) {
    std::vector<PlannedBatch> missing;
    for (std::size_t scene = 0; scene < run.setup.scenes.size(); ++scene)
        if (run.list.has(scene))
            for (const ReferenceBatch& batch : run.references.advance(scene, most_own_work))
                missing.push_back({scene, batch});
    run.list.use(run.references);
    run.write_index();
    require_made(made, missing);
    if (missing.empty()) submission.submit_cells();
    else submission.submit_batches(missing);
}

void make_batches(const RunOptions& options, const RunSession& run, const std::vector<PlannedBatch>& batches) {
    for (std::size_t scene = 0; scene < run.setup.scenes.size(); ++scene) {
        std::vector<ReferenceBatch> own;
        for (std::size_t i = 0; i < batches.size(); ++i)
            if (batches[i].scene == scene && options.share.value().has(i)) own.push_back(batches[i].batch);
        if (!own.empty()) run.references.make_batches(scene, own);
    }
}

/// Measures the cells of this task's share, with the references that are there.
void measure_cells(const RunOptions& options, RunSession& run) {
    run.list.select(options.share.value());
    run_cells(left_of(run.list.with_records(run.folder)), run.runner, run.log.progress);
}

void report(RunSession& run, std::ostream& out) {
    const FileLock lock = lock_result_folder(run.folder.path());
    const std::string left = run.what_is_left();
    out << "Report: " << run.write_results() << "\n";
    if (!left.empty()) throw RunError(left);
}

}  // namespace

int submit_run(const RunOptions& options, const SlurmOptions& slurm, std::ostream& out) {
    require_slurm();
    RunSession run(checked_setup(load_experiment(options.experiment), options), options, FolderUse::shared);
    Submission submission(run, options, slurm, out);
    if (options.fresh && !submission.active().tasks.empty())
        reject({}, "--fresh would delete what the jobs of '{}' measure: wait for them or cancel them",
               run.folder.path());
    if (options.fresh) run.forget_cells();
    const auto references = submission.active().numbers(references_job);
    if (references.empty()) go_on(run, submission, 0);
    else out << fmt::format("job {} makes references and submits the cells\n", *references.begin());
    out << fmt::format("`gibench status {}` prints their progress\n", run.folder.path());
    return run.log.exit_code();
}

int run_job(const RunOptions& options, const SlurmOptions& slurm, const std::vector<std::string>& job,
            std::ostream& out) {
    const InterruptGuard guard;
    RunSession run(checked_setup(load_experiment(options.experiment), options), options, FolderUse::shared);
    const std::string& kind = job.front();
    if (kind == batches_job) {
        make_batches(options, run, read_batches(job.at(1)));
    } else if (kind == references_job) {
        Submission submission(run, options, slurm, out);
        go_on(run, submission, most_work_of_job, read_batches(job.at(1)));
    } else if (kind == cells_job) {
        measure_cells(options, run);
    } else if (kind == report_job) {
        report(run, out);
    } else {
        reject({}, "there is no job of the kind '{}'", kind);
    }
    return run.log.exit_code();
}

void require_no_jobs(const RunOptions& options) {
    const std::string folder = result_folder_of(options.out, fs::path(options.experiment).stem().string());
    const JobFolder jobs(folder);
    if (!jobs.exists()) return;
    try {
        if (ActiveJobs(jobs.read()).tasks.empty()) return;
    } catch (const RunError&) {
        return;  // no Slurm here that could run them
    }
    reject({}, "jobs of Slurm are working in '{}': wait until they have ended (`gibench status {}`), or cancel them",
           folder, folder);
}

}  // namespace gib
