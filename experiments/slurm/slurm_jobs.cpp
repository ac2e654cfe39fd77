#include "experiments/slurm/slurm_jobs.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <filesystem>

namespace gib {

using nlohmann::json;
namespace fs = std::filesystem;

static auto json_fields(RecordOf<SubmittedJob> auto& j) {
    return std::tuple(JsonField{"kind", j.kind}, JsonField{"number", j.number}, JsonField{"shares", j.shares},
                      JsonField{"cells", j.cells});
}

static auto json_fields(RecordOf<PlannedBatch> auto& b) {
    return std::tuple(JsonField{"scene", b.scene}, JsonField{"maker", b.batch.method},
                      JsonField{"number", b.batch.number}, JsonField{"passes", b.batch.passes},
                      JsonField{"passes_before", b.batch.passes_before});
}

namespace {

/// A file of this folder. `what`: its content, for the message.
template <typename Record>
Record read_record(const std::string& path, const char* what) {
    try {
        return read_json(path).get<Record>();
    } catch (const json::exception& error) {
        throw InputError({path}, fmt::format("not {}: {}", what, error.what()));
    }
}

}  // namespace

std::vector<PlannedBatch> read_batches(const std::string& path) {
    return read_record<std::vector<PlannedBatch>>(path, "a list of batches");
}

bool JobFolder::exists() const { return fs::exists(path_ + "/jobs.json"); }

std::vector<SubmittedJob> JobFolder::read() const {
    using Jobs = std::vector<SubmittedJob>;
    return exists() ? read_record<Jobs>(path_ + "/jobs.json", "a list of jobs") : Jobs{};
}

void JobFolder::write(const std::vector<SubmittedJob>& jobs) const {
    write_file(path_ + "/jobs.json", json(jobs).dump() + "\n");
}

std::string JobFolder::add_batches(const std::vector<PlannedBatch>& batches) const {
    for (int number = 1;; ++number) {
        const std::string path = fmt::format("{}/batches-{}.json", path_, number);
        if (fs::exists(path)) continue;
        write_file(path, json(batches).dump() + "\n");
        return path;
    }
}

std::string JobFolder::log_of_task(const SubmittedJob& job, std::size_t task) const {
    return fmt::format("{}/{}-{}_{}.txt", path_, job_name(job.kind), job.number, task);
}

ActiveJobs::ActiveJobs(const std::vector<SubmittedJob>& jobs) {
    if (jobs.empty()) return;
    for (const SlurmTask& task : active_tasks())
        for (const SubmittedJob& job : jobs)
            if (job.number == task.job && job.number != own_job()) tasks.push_back({job, task.index});
}

std::set<std::uint64_t> ActiveJobs::numbers(const std::string& kind) const {
    std::set<std::uint64_t> found;
    for (const Task& task : tasks)
        if (task.job.kind == kind) found.insert(task.job.number);
    return found;
}

std::set<std::string> ActiveJobs::cells() const {
    std::set<std::string> cells;
    for (const Task& task : tasks)
        for (std::size_t i = 0; i < task.job.cells.size(); ++i)
            if (RunShare{task.index, task.job.shares}.has(i)) cells.insert(task.job.cells[i]);
    return cells;
}

}  // namespace gib
