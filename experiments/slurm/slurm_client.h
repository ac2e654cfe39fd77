#pragma once
// The commands of Slurm that gibench calls: sbatch, squeue and scontrol. Slurm alone decides when and where a job runs.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// A job or one task of an array job that waits or runs.
struct SlurmTask {
    std::uint64_t job = 0;  ///< number of the whole array
    std::size_t index = 0;  ///< place in its array
};

/// In the arguments of an array job: the index of the task.
inline constexpr const char* task_index = "$SLURM_ARRAY_TASK_ID";

struct SlurmJob {
    std::string name;
    std::vector<std::string> command;  ///< program and arguments; `task_index` is replaced by the index of the task
    std::vector<std::size_t> tasks;    ///< indices of the tasks of an array; none: no array
    int cpus = 1;                      ///< number of processors for each task
    std::string log_folder;
    std::vector<std::uint64_t> after;       ///< begins when these have ended, however they ended
    std::vector<std::string> user_options;  ///< options for sbatch, which override ours
};

/// Throws InputError, with what to do, unless Slurm's commands are on the PATH.
void require_slurm();

/// The largest number of tasks in an array job: MaxArraySize of `scontrol show config`. Throws RunError, also
/// if Slurm takes none.
std::size_t largest_array();

/// All jobs of this user that have not ended. Throws RunError.
std::vector<SlurmTask> active_tasks();

/// Submits a job and returns its number. Each task is a step of its own whose cores are bound (srun), and is requeued
/// when its node fails. Throws RunError with sbatch's message.
std::uint64_t submit_job(const SlurmJob& job);

/// The number of the job that this process belongs to; 0: none.
std::uint64_t own_job();

/// Removes Slurm's variables of this process's own job from the environment, because sbatch and srun would take it
/// for options of the next one.
void forget_own_job();

/// A path as sbatch's --output takes it, where % begins a replacement symbol and %% stands for %. Throws InputError for
/// a backslash, which would switch off all replacement symbols of the pattern (sbatch(1), "filename pattern").
std::string log_pattern(const std::string& path);

}  // namespace gib
