#include "experiments/slurm/slurm_jobs.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/results/result_folder.h"
#include "experiments/text/json_file.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace gib {

using nlohmann::json;
namespace fs = std::filesystem;

static auto json_fields(RecordOf<SubmittedJob> auto& j) {
    return std::tuple(JsonField{"kind", j.kind}, JsonField{"number", j.number}, JsonField{"plan", j.plan});
}

static auto json_fields(RecordOf<SlurmJobs> auto& j) {
    return std::tuple(JsonField{"sbatch", j.user_options}, JsonField{"tasks", j.most_tasks}, JsonField{"jobs", j.jobs});
}

bool JobFolder::exists() const { return fs::exists(path_ + "/jobs.json"); }

SlurmJobs JobFolder::read() const {
    if (!exists()) return {};
    const std::string path = path_ + "/jobs.json";
    try {
        return read_json(path).get<SlurmJobs>();
    } catch (const json::exception& error) {
        throw InputError({path}, fmt::format("not a list of jobs: {}", error.what()));
    }
}

void JobFolder::write(const SlurmJobs& jobs) const { write_file(path_ + "/jobs.json", json(jobs).dump(1) + "\n"); }

std::string JobFolder::add_plan(const RunPlan& plan) const {
    for (int number = 1;; ++number) {
        const std::string path = fmt::format("{}/plan-{}.json", path_, number);
        if (fs::exists(path)) continue;
        write_plan(path, plan);
        return path;
    }
}

std::vector<std::uint64_t> ActiveJobs::numbers(const std::string& kind) const {
    std::vector<std::uint64_t> found;
    for (const Task& task : tasks)
        if (task.job.kind == kind && std::find(found.begin(), found.end(), task.job.number) == found.end())
            found.push_back(task.job.number);
    return found;
}

ActiveJobs active_jobs(const SlurmJobs& jobs) {
    ActiveJobs active;
    if (jobs.jobs.empty()) return active;
    for (const SlurmTask& task : active_tasks())
        for (const SubmittedJob& job : jobs.jobs)
            if (job.number == task.job) active.tasks.push_back({job, task.index.value_or(0), task.runs});
    return active;
}

std::map<std::string, bool> active_cells(const ActiveJobs& active) {
    std::map<std::string, bool> cells;
    std::map<std::string, RunPlan> plans;
    for (const ActiveJobs::Task& task : active.tasks) {
        if (task.job.kind != cells_job) continue;
        if (plans.count(task.job.plan) == 0) plans[task.job.plan] = read_plan(task.job.plan);
        const RunPlan& plan = plans[task.job.plan];
        if (task.index >= plan.cells.size()) continue;
        for (const CellPlace& place : plan.cells[task.index])
            cells[cell_folder_name(plan.scenes.at(place.scene).name, plan.methods.at(place.method), place.seed)] =
                task.runs;
    }
    return cells;
}

}  // namespace gib
