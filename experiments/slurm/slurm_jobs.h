#pragma once
// The jobs of a result folder, as its folder slurm/ keeps them: their numbers and cells (jobs.json), the batches of
// references that array jobs make (batches-N.json), and what the jobs print.

#include "experiments/plan/run_options.h"
#include "experiments/references/store.h"
#include "experiments/slurm/slurm_client.h"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace gib {

// The kinds of jobs, in their order.
inline constexpr const char *batches_job = "batches", *references_job = "references", *cells_job = "cells",
                            *report_job = "report";

/// The name of a job of this kind in Slurm and in the names of its logs.
inline std::string job_name(const std::string& kind) { return "gibench-" + kind; }

struct SubmittedJob {
    std::string kind;
    std::uint64_t number = 0;
    std::size_t shares = 0;               ///< number of shares of `cells`; a task runs the share of its index
    std::vector<std::string> cells = {};  ///< names of the folders of all selected cells, in their order
};

/// A batch of the reference of a scene, by its place in the experiment's list.
struct PlannedBatch {
    std::size_t scene = 0;
    ReferenceBatch batch;

    friend bool operator==(const PlannedBatch&, const PlannedBatch&) = default;
};
/// The batches of an array job, whose tasks make a share each. Throws InputError if the file is missing or is no list.
std::vector<PlannedBatch> read_batches(const std::string& path);

class JobFolder {
public:
    explicit JobFolder(const std::string& results) : path_(results + "/slurm") {}

    const std::string& path() const { return path_; }
    bool exists() const;
    /// No jobs if there is no file.
    std::vector<SubmittedJob> read() const;
    void write(const std::vector<SubmittedJob>& jobs) const;
    /// Writes a list under a new name and returns its path.
    std::string add_batches(const std::vector<PlannedBatch>& batches) const;
    /// The file that holds the output of a task of an array job, unless --sbatch has another --output.
    std::string log_of_task(const SubmittedJob& job, std::size_t task) const;

private:
    std::string path_;
};

/// The tasks of a folder's jobs that have not ended. Those of this process's own job do not count.
struct ActiveJobs {
    explicit ActiveJobs(const std::vector<SubmittedJob>& jobs);

    /// The numbers of the jobs of this kind.
    std::set<std::uint64_t> numbers(const std::string& kind) const;
    /// The cells of the tasks, by the names of their folders.
    std::set<std::string> cells() const;

    struct Task {
        SubmittedJob job;
        std::size_t index = 0;
    };
    std::vector<Task> tasks;
};

}  // namespace gib
