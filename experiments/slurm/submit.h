#pragma once
// Runs an experiment as jobs of Slurm (`gibench run --on slurm`): an array job makes batches of the references, a job
// that waits for it adds them up, an array job measures the cells, and the last one writes tables and report.
//
// A reference ends at a target that nobody knows the way to in advance. Therefore the job that adds up the batches
// predicts, by the 1 / sqrt(n) law, the rounds that are left, and submits their batches and itself again; the cells
// then wait for that. What is short enough it does itself. The result is the same bit for bit as a local run's.
//
// Each job begins when those before it have ended, however they ended, and works with what is there. Nothing hangs on a
// task that failed: the same command submits what is missing.

#include "experiments/plan/run_options.h"

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace gib {

struct SlurmOptions {
    std::vector<std::string> user_options;  ///< options for sbatch
    std::size_t most_tasks = 256;  ///< limit on the tasks of an array; a task runs several cells if there are more
};

/// Submits what is missing of an experiment and neither waits nor runs, and prints the jobs to `out`. Returns the exit
/// code. Throws InputError if Slurm is not there or the experiment is wrong, RunError if Slurm refuses a job.
int submit_run(RunOptions options, const SlurmOptions& slurm, std::ostream& out);

/// Does the work of a job of this kind, in an array job that of the task. Returns the exit code: 1 if a part failed.
int run_task(const std::string& plan, const std::string& kind, std::ostream& out);

/// Throws InputError if jobs of an earlier submission wait or run, because a local run would take their place.
void require_no_jobs(const RunOptions& options);

}  // namespace gib
