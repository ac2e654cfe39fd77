#include "experiments/slurm/status.h"

#include "common/core/files.h"
#include "experiments/results/result_folder.h"
#include "experiments/slurm/slurm_jobs.h"
#include "experiments/system/file_lock.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <ostream>
#include <set>

namespace gib {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 5> state_names = {"done", "running", "waiting", "failed", "missing"};
enum State : std::size_t { done, running, waiting, failed, missing };

/// The cells that belong to a run that has begun: how they are known, and whether somebody works on them.
struct Work {
    std::set<std::string> cells;  ///< in tasks, by name
    bool more_to_come = false;    ///< whether a local run or a job of references will get to the others
    std::string warning;
};

Work work_in(const std::string& folder) {
    Work work;
    const JobFolder jobs(folder);
    try {
        if (jobs.exists()) {
            const ActiveJobs active(jobs.read());
            work.cells = active.cells();
            work.more_to_come = !active.numbers(references_job).empty();
        }
    } catch (const RunError& error) {
        work.warning = fmt::format("Slurm does not say which jobs wait or run: {}", error.what());
    }
    if (is_locked(folder + "/.lock")) work.more_to_come = true;
    return work;
}

State state_of(const ResultFolder& folder, const std::string& name, const ResultIndex& index, const Work& work) {
    const auto key = index.cell_keys.find(name);
    if (key != index.cell_keys.end() && folder.read_cell(name, key->second)) return done;
    if (is_locked(folder.cell_lock(name))) return running;
    if (work.cells.count(name) > 0) return waiting;
    if (fs::exists(folder.failure_file(name))) return failed;
    return work.more_to_come ? waiting : missing;
}

/// Says which tasks of cells have ended and left nothing: their cells are missing, and there is no log. Only the last
/// job that was to measure a cell counts.
std::string tasks_without_a_trace(const JobFolder& folder, std::set<std::string> missing) {
    std::string text;
    std::vector<SubmittedJob> jobs = folder.read();
    std::ranges::reverse(jobs);
    for (const SubmittedJob& job : jobs) {
        std::set<std::size_t> silent;
        for (std::size_t i = 0; i < job.cells.size(); ++i)
            if (missing.erase(job.cells[i]) > 0 && !fs::exists(folder.log_of_task(job, i % job.shares)))
                silent.insert(i % job.shares);
        if (!silent.empty())
            text += fmt::format(
                "{} {} of job {} ended without a trace: no cell and no log in {}; `sacct -j {}` may say why, and the "
                "command that submitted this run submits the cells again\n",
                silent.size(), silent.size() == 1 ? "task" : "tasks", job.number, folder.path(), job.number);
    }
    return text;
}

}  // namespace

int print_status(const std::string& path, std::ostream& out) {
    const ResultFolder folder(path);
    if (!fs::exists(folder.file("index.json")) && is_locked(folder.file(".lock"))) {
        out << "references: being made; no cell has begun\n";
        return 0;
    }
    const ResultIndex index = folder.read_index();
    const Work work = work_in(path);
    if (!work.warning.empty()) std::cerr << "warning: " << work.warning << "\n";
    std::array<std::size_t, state_names.size()> counts{};
    std::string list;
    std::set<std::string> missing_cells;
    for (int seed = 1; seed <= index.seeds; ++seed)
        for (const auto& scene : index.scenes)
            for (const auto& method : index.methods) {
                const auto name = cell_folder_name(scene.name, method, static_cast<std::uint64_t>(seed));
                const State state = state_of(folder, name, index, work);
                ++counts[state];
                if (state == missing) missing_cells.insert(name);
                if (state == done || state == waiting) continue;
                std::string why;
                if (state == failed) why = ": " + read_file(folder.failure_file(name));
                while (!why.empty() && why.back() == '\n')
                    why.pop_back();
                list += fmt::format("{}: {}, {}, seed {}{}\n", state_names[state], scene.name, method, seed, why);
            }
    std::size_t references = 0;
    for (const auto& scene : index.scenes)
        references += !scene.reference.empty() ? 1 : 0;
    out << fmt::format("references: {} of {}\n", references, index.scenes.size());
    for (std::size_t state = 0; state < counts.size(); ++state)
        out << fmt::format("{}: {}\n", state_names[state], counts[state]);
    out << list;
    if (work.warning.empty()) out << tasks_without_a_trace(JobFolder(path), std::move(missing_cells));
    return counts[failed] + counts[missing] > 0 ? exit_failed : 0;
}

}  // namespace gib
