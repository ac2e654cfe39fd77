#pragma once
// Runs an experiment as jobs of Slurm (`gibench run --on slurm`): an array job makes batches of the references; a job
// that waits for it adds them up and goes on with the submission; an array job runs shares of the cells (`gibench run
// --share`); the last one writes tables and report. All of them are this program with the options of the run.
//
// A reference ends at a target that nobody knows the way to in advance. Therefore the job that adds up the batches
// predicts, by the 1 / sqrt(n) law, the rounds that are left, and submits their batches and itself again, or else the
// cells. Short work it does itself. The result is the same bit for bit as a local run's.
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
    std::string sbatch;                     ///< options for sbatch, as typed
    std::vector<std::string> user_options;  ///< its words
    std::size_t most_tasks = 256;           ///< limit on the tasks of an array
};

/// Submits what is missing of an experiment and neither waits nor runs, and prints the jobs to `out`. Returns the exit
/// code. Throws InputError if Slurm is not there or the experiment is wrong, RunError if Slurm refuses a job.
int submit_run(const RunOptions& options, const SlurmOptions& slurm, std::ostream& out);

/// Does the work of a job: its kind (slurm_jobs.h) and, for those of references, the file of its batches. Returns the
/// exit code: 1 if a part failed.
int run_job(const RunOptions& options, const SlurmOptions& slurm, const std::vector<std::string>& job,
            std::ostream& out);

/// Throws InputError if jobs of an earlier submission wait or run, because a local run would take their place.
void require_no_jobs(const RunOptions& options);

}  // namespace gib
