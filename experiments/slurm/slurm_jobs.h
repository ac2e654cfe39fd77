#pragma once
// The jobs of a result folder, as its folder slurm/ keeps them: the plans that tasks read (plan-N.json), the numbers
// of the jobs (jobs.json), and what the tasks print.

#include "experiments/run/run_plan.h"
#include "experiments/slurm/slurm_client.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gib {

// The kinds of jobs, in their order.
inline constexpr const char *batches_job = "batches", *merge_job = "merge", *cells_job = "cells",
                            *report_job = "report";

struct SubmittedJob {
    std::string kind;
    std::uint64_t number = 0;
    std::string plan;  ///< path of its plan
};

struct SlurmJobs {
    std::vector<std::string> user_options;  ///< options for sbatch in the last submission
    std::size_t most_tasks = 1;             ///< limit on the tasks of an array
    std::vector<SubmittedJob> jobs;
};

class JobFolder {
public:
    explicit JobFolder(const std::string& results) : path_(results + "/slurm") {}

    const std::string& path() const { return path_; }
    bool exists() const;
    /// No jobs if there is no file.
    SlurmJobs read() const;
    void write(const SlurmJobs& jobs) const;
    /// Writes a plan under a new name and returns its path.
    std::string add_plan(const RunPlan& plan) const;

private:
    std::string path_;
};

/// The tasks of a folder's jobs that have not ended.
struct ActiveJobs {
    struct Task {
        SubmittedJob job;
        std::size_t index = 0;
        bool runs = false;
    };
    std::vector<Task> tasks;

    /// The numbers of the jobs of this kind, each once.
    std::vector<std::uint64_t> numbers(const std::string& kind) const;
};
ActiveJobs active_jobs(const SlurmJobs& jobs);

/// The cells of the active tasks, by the names of their folders, and whether their task runs.
std::map<std::string, bool> active_cells(const ActiveJobs& active);

}  // namespace gib
