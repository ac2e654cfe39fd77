#pragma once
// The commands of Slurm that gibench calls: sbatch, squeue and scontrol. Slurm alone decides when and where a job runs.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// A job or one task of an array job that waits or runs.
struct SlurmTask {
    std::uint64_t job = 0;             ///< number of the whole array
    std::optional<std::size_t> index;  ///< place in its array
    bool runs = false;                 ///< false: it waits
};

struct SlurmJob {
    std::string name;
    std::vector<std::string> command;  ///< program and arguments of each task
    std::size_t tasks = 0;             ///< number of tasks in an array; 0: no array
    int cpus = 1;                      ///< number of processors for each task
    std::string log_folder;
    std::vector<std::uint64_t> after;       ///< begins when these have ended, however they ended
    std::vector<std::string> user_options;  ///< options for sbatch, which override ours
};

/// Throws InputError, with what to do, unless Slurm's commands are on the PATH.
void require_slurm();

/// The largest number of tasks in an array job: MaxArraySize of `scontrol show config`. Throws RunError.
std::size_t largest_array();

/// All jobs of this user that have not ended. Throws RunError.
std::vector<SlurmTask> active_tasks();

/// Submits a job and returns its number. Each task is a step of its own whose cores are bound (srun), and is requeued
/// when its node fails. Throws RunError with sbatch's message.
std::uint64_t submit_job(const SlurmJob& job);

/// Makes a job that still waits begin after another one has ended, instead of what it waited for. Throws RunError.
void set_dependency(std::uint64_t job, std::uint64_t after);

/// The place of this process in its array job; 0 outside an array.
std::size_t own_array_index();

/// Removes what Slurm has told this process about its own job from the environment, because sbatch and srun would take it
/// for options of the next one.
void forget_own_job();

}  // namespace gib
